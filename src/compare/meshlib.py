"""One offset with MeshLib, for `exocarp compare`. Arguments: one JSON object. Prints one line of JSON."""
import json
import os
import sys
import time

job = json.loads(sys.argv[1])
try:
    # MeshLib has one thread per core that it may run on, so its threads are bounded by bounding the cores.
    cores = sorted(os.sched_getaffinity(0))[: job["threads"]]
    os.sched_setaffinity(0, cores)
except (AttributeError, OSError):
    pass
import meshlib.mrmeshpy as mm  # noqa: E402 (reads the number of cores)


def peak_memory():
    try:
        with open("/proc/self/status") as status:
            line = next(line for line in status if line.startswith("VmHWM:"))
        return int(line.split()[1]) * 1024
    except (OSError, StopIteration):
        return None


mesh = mm.loadMesh(job["input"])
parameters = mm.GeneralOffsetParameters()
parameters.voxelSize = job["voxel"]
parameters.signDetectionMode = mm.SignDetectionMode.OpenVDB
modes = {"meshlib-standard": mm.OffsetMode.Standard, "meshlib-sharp": mm.OffsetMode.Sharpening}
parameters.mode = modes[job["method"]]

before = peak_memory()
start = time.perf_counter()
result = mm.generalOffsetMesh(mesh, job["distance"], parameters)
engine = time.perf_counter() - start
peak = peak_memory()
mm.saveMesh(result, job["output"])
print(
    json.dumps(
        {
            "method": job["method"],
            "engine": engine,
            "peak_memory": peak,
            "memory_before": before,
            "active_voxels": None,
            "triangles": result.topology.numValidFaces(),
        }
    )
)
