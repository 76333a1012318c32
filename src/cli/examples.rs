//! Examples, printed below the help of the program and of its commands.

pub(super) const ALL: &str = "\
Examples:
  exocarp model carved_cube -o cube.ply
  exocarp offset cube.ply -d 2% -o grown.ply
  exocarp offset cube.ply -d -2% --resolution 512 -o shrunk.stl --vdb shrunk.vdb
  exocarp info shrunk.vdb
  exocarp verify cube.ply grown.ply -d 2%

Exit codes: 0 done, 1 internal error, 2 wrong use, 3 bad input, 4 the result is empty,
5 a limit was hit (memory, size), 6 verify found a broken promise, 130 interrupted.";

pub(super) const OFFSET: &str = "\
Examples:
  exocarp offset part.stl -d 0.5 -o grown.stl              0.5 model units outward
  exocarp offset part.stl -d -2% -o shrunk.ply             2% of the diagonal inward
  exocarp offset part.stl -d 0 --voxel 0.1 -o remesh.obj   a sharp, clean remesh
  exocarp offset part.stl -d 1% -o a.ply --vdb a.vdb --stats a.json
  exocarp offset part.stl -d 1% --tolerance 0.02h -o a.ply     within 0.02 voxels of the true offset
  exocarp offset scan.ply -d 1% --sign pseudonormal -o a.ply   an input with holes
  exocarp offset part.stl -d 1% --vdb a.vdb                    the narrow band only
  exocarp offset part.stl -d 1% --resolution 4096 --stream --max-memory 4G -o huge.ply

Lengths are in model units (those of the input file); percentages are of the diagonal of the input's
bounding box. Formats by extension, in and out: .obj .ply .stl .off";

pub(super) const MERGE: &str = "\
Examples:
  for i in 1 2 3 4; do exocarp offset big.stl -d 1% --resolution 4096 --tile $i/4 -o tile$i.ply; done
  exocarp merge tile*.ply -o grown.ply                     the very file of an undivided run

Each tile can be made on a machine of its own; all need the same input and settings.";

pub(super) const THICKEN: &str = "\
Examples:
  exocarp thicken face.ply -t 2.5 -o mask.stl                   behind the patch, 2.5 model units thick
  exocarp thicken face.ply -t 1% --side outer -o mask.ply       in front of it, 1% of the diagonal
  exocarp thicken face.ply -t 1% --resolution 512 -o mask.ply   a finer lattice for wall and inner shell
  exocarp thicken closed.ply -t 1 -o shell.ply                  a closed mesh gets a cavity

Every triangle of PATCH is in SOLID with the same coordinates, rounded to 32 bits where they have more; with
--f64 (PLY, OBJ, OFF) they stay as they are. The voxel size must be less than half of the thickness.";

pub(super) const COMPARE: &str = "\
Examples:
  exocarp compare part.stl -d 2%
  exocarp compare part.stl -d -2% --resolution 512 --report out --json out/figures.json
  exocarp compare part.stl -d 2% --methods exocarp,openvdb-wide --runs 1
  exocarp compare part.stl -d 2% --python venv/bin/python        an interpreter with meshlib

Methods: exocarp, openvdb-wide, openvdb-first, openvdb-weno5, meshlib-standard, meshlib-sharp.";

pub(super) const MODEL: &str = "\
Examples:
  exocarp model                                    the list of models
  exocarp model anchor -o anchor.stl
  exocarp model sphere --detail 64 -o sphere.ply";

pub(super) const INFO: &str = "\
Examples:
  exocarp info part.stl
  exocarp info band.vdb
  exocarp info part.stl --json";

pub(super) const VERIFY: &str = "\
Examples:
  exocarp verify part.stl grown.stl -d 2%                        topology, intersections, errors
  exocarp verify part.stl grown.stl -d 2% --voxel 0.1            errors in voxels as well
  exocarp verify part.stl grown.stl -d 0.5 --tolerance 0.01      exit code 6 if it is off by more
  exocarp verify part.stl hollow.stl -d -2 --shell --json v.json the wall of a hollowed part

OUTPUT is judged as it is on disk, whichever program wrote it; only vertices at exactly the same position are
made one first. Ends with exit code 6 if OUTPUT is not closed, not 2-manifold, not consistently oriented, if it
has triangles without area or that intersect, or if an error is above --tolerance.";

pub(super) const PAPER: &str = "\
Examples:
  exocarp paper --table 1                            generated models, 513^3 nodes as in the paper
  exocarp paper --table 4 --models meshes            models by name: fandisk, armadillo, rocker-arm, ...
  exocarp paper --resolution 128 --json tables.json  all tables, a quick look

The paper: Liu and Wang, Fast intersection-free offset surface generation from freeform models with
triangular meshes, IEEE T-ASE 8(2), 2011. Most of its models are not public; each table says what stands
for them.";
