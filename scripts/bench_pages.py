"""The pages that bench_report.py writes from what it measured."""

import re
import textwrap

import wrap
from bench_templates import BENCHMARKS, COMPARE, PAPER

# The cases with pictures: the figures that are kept of the page of `exocarp compare --report`.
PICTURES = {
    ("carved_cube", "2%", 256): ["section-1"],
    ("fandisk", "2%", 256): ["section-1"],
    ("armadillo", "2%", 256): ["section-2"],
}
TITLES = {
    "exocarp": "exocarp",
    "openvdb-wide": "OpenVDB wide band",
    "openvdb-first": "OpenVDB offset, 1st order",
    "openvdb-weno5": "OpenVDB offset, WENO5",
    "meshlib-standard": "MeshLib standard",
    "meshlib-sharp": "MeshLib sharpening",
}
CAPTION = (
    "Black is the true offset curve, grey the true solid, wide and coloured the method's outline."
)
# Around the figures of README.md.
FIRST_MARK, LAST_MARK = "<!-- figures: written by make bench-report -->", "<!-- end of figures -->"
MEGABYTE = 1e6
# Pixels between the panels of a picture, and below each for its name.
GAP, FOOT = 12, 26


def count(n):
    return "-" if n is None else f"{n:,}"


def seconds(t):
    return "-" if t is None else f"{t:.2f}" if t >= 0.095 else f"{t:.3f}"


def error(x):
    """An error in voxels, with two significant digits where it is small."""
    return (
        "-"
        if x is None
        else "0"
        if x == 0
        else f"{x:.4f}"
        if x < 0.01
        else f"{x:.3f}"
        if x < 1
        else f"{x:.2f}"
    )


def megabytes(b):
    return "-" if b is None else f"{b / MEGABYTE:.0f}"


def table(head, rows):
    """A Markdown table; the first column is text, the others are numbers."""
    rule = "|---|" + "--:|" * (len(head) - 1)
    lines = ["| " + " | ".join(head) + " |", rule]
    return "\n".join(lines + ["| " + " | ".join(map(str, row)) + " |" for row in rows]) + "\n"


def head(data):
    """The commit, the date and the machine."""
    m = data["machine"]
    virtual = ", virtual" if m["virtual"] else ""
    programs = [m["system"], m["rustc"]]
    programs += [
        f"{name} {m[key]}"
        for name, key in (("OpenVDB", "openvdb"), ("MeshLib", "meshlib"))
        if m[key]
    ]
    text = f"- Commit {data['commit']}, {data['date']}, {'a quick run' if data['quick'] else 'a full run'}.\n"
    text += f"- {m['cpu']}{virtual}, {m['cores']} cores, {m['memory']:.0f} GB.\n"
    text += f"- {', '.join(p for p in programs if p)}.\n"
    runs = "from one run each" if data["runs"] == 1 else f"medians of {data['runs']} runs"
    text += f"- Times and memory are {runs}, with two threads, if nothing else is said.\n"
    if m["load"] > 0.5:
        text += f"- **Other work ran on the machine** (load {m['load']:.1f} at the start): times are upper bounds.\n"
    return text


def method_row(result):
    """What the tables need of a method: time, memory, triangles and quality."""
    measured, quality = result["median"], result["quality"]
    if not measured or not quality:
        return None
    topology = quality["topology"]
    share = quality["creases"]["share"]
    return {
        "engine": measured["engine"],
        "memory": measured["peak_memory"],
        "phases": {p["name"]: p["seconds"] for p in measured["phases"]},
        "active": measured["active_voxels"],
        "triangles": measured["triangles"],
        "mean": quality["distance"]["surface"]["mean"]["voxels"],
        "max": quality["distance"]["max"]["voxels"],
        "missing": quality["missing"]["max"]["voxels"],
        "creases": "-" if share is None else f"{100 * share:.1f}",
        "pairs": quality["intersections"]["pairs"],
        "bad": topology["non_manifold_edges"] + topology["non_manifold_vertices"],
        "runs": len(result["runs"]),
    }


def peers(data):
    """Two tables: times and memory, then quality, with the peers beside each other."""
    times, quality = [], []
    for case in data["peers"]:
        rows = {r["method"]: method_row(r) for r in case["result"]["results"]}
        name = f"{case['model']}, {case['distance']}, {case['resolution']}"
        own = rows.get("exocarp")
        for method, row in rows.items():
            if not row or not own:
                continue
            factor = "" if method == "exocarp" else f"{row['engine'] / own['engine']:.1f}x"
            label = f"**{TITLES[method]}**" if method == "exocarp" else TITLES[method]
            first = name if method == "exocarp" else ""
            cells = [
                seconds(row["engine"]),
                factor,
                megabytes(row["memory"]),
                count(row["triangles"]),
            ]
            times.append([first, label, *cells])
            cells = [error(row["mean"]), error(row["max"]), error(row["missing"]), row["creases"]]
            quality.append([first, label, *cells, count(row["pairs"]), count(row["bad"])])
    columns = ["model, distance, voxels", "method"]
    return (
        table([*columns, "engine, s", "factor", "memory, MB", "triangles"], times),
        table(
            [*columns, "mean", "max", "missing", "creases, %", "crossing pairs", "non-manifold"],
            quality,
        ),
    )


def growth(data):
    rows = []
    for r in data["growth"]:
        p = r["phases"]
        parts = [seconds(p.get(name)) for name in ("hierarchy", "band", "edges", "contour")]
        each = 1e6 * r["engine"] / r["triangles"]
        tail = [count(r["triangles"]), f"{each:.2f}", megabytes(r["memory"])]
        rows.append(
            [
                f"{r['model']}, {r['distance']}, {r['resolution']}",
                seconds(r["engine"]),
                *parts,
                *tail,
            ]
        )
    head = ["model, distance, voxels", "engine, s", "hierarchy", "band", "edges", "contour"]
    return table([*head, "triangles", "us each", "memory, MB"], rows)


def threads(data):
    rows = []
    for r in data["threads"]:
        spread = f"{seconds(r['range'][0])} to {seconds(r['range'][1])}"
        same = {True: "yes", False: "**no**", None: ""}[r.get("same")]
        rows.append([r["model"], r["threads"], seconds(r["engine"]), spread, same])
    return table(["model", "threads", "engine, s", "range", "same bytes"], rows)


def streaming(data):
    s = data["streaming"]
    rows = []
    for r in s["rows"]:
        cells = [
            count(r["slabs"]),
            seconds(r["wall"]),
            megabytes(r["memory"]),
            count(r["triangles"]),
        ]
        rows.append([f"{r['model']}, {r['resolution']}, {r['way']}", *cells])
    same = (
        "The two files are the same, byte for byte." if s["same"] else "**The two files differ.**"
    )
    return (
        table(["model, voxels, way", "slabs", "command, s", "memory, MB", "triangles"], rows)
        + "\n"
        + same
        + "\n"
    )


def noisy(data):
    rows = []
    for r in data["noisy"]:
        what = f"{r['model']}, noisy" if r["cuts"] else r["model"]
        quality = r["report"]
        bad = quality["topology"]["border_edges"] + quality["topology"]["non_manifold_edges"]
        cells = [count(r["input"]), count(r["crossed"]), count(r["jumps"]), seconds(r["engine"])]
        cells += [seconds(r["phases"]["contour"]), megabytes(r["memory"])]
        cells += [error(quality["missing"]["faces"]["mean"]["voxels"])]
        rows.append([what, *cells, count(quality["intersections"]["pairs"]), count(bad)])
    columns = [
        "scan",
        "triangles",
        "crossed edges",
        "jumps",
        "engine, s",
        "contour, s",
        "memory, MB",
    ]
    return table([*columns, "missing, mean", "crossing pairs", "bad edges"], rows)


def thickening(data):
    rows = []
    for r in data["thickening"]:
        parts = [
            seconds(r["phases"].get(n))
            for n in ("hierarchy", "nodes", "faces", "boundary", "shape")
        ]
        name = f"{r['model']}, {r['thickness']}, {r['resolution']}"
        engine = seconds(r["engine"])
        rows.append(
            [name, count(r["input"]), engine, *parts, count(r["new"]), megabytes(r["memory"])]
        )
    columns = [
        "patch, thickness, voxels",
        "triangles",
        "engine, s",
        "hierarchy",
        "nodes",
        "faces",
        "boundary",
        "shape",
    ]
    return table([*columns, "new triangles", "memory, MB"], rows)


def compare_case(case, pictures):
    """All columns of one comparison, and its pictures."""
    result = case["result"]
    text = f"## {case['model']}, {case['distance']}, resolution {case['resolution']}\n\n"
    voxels = result["distance"] / result["voxel"]
    text += f"{count(result['input_triangles'])} triangles in, offset by {voxels:+.1f} voxels.\n\n"
    rows = []
    for r in result["results"]:
        row = method_row(r)
        title = TITLES[r["method"]]
        if not row:
            rows.append([title, f"{r['lost']}"] + [""] * 12)
            continue
        phases = row["phases"]
        edges = phases.get("edges", phases.get("offset"))
        once = " (once)" if row["runs"] < result["runs"] else ""
        cells = [seconds(phases.get("hierarchy")), seconds(phases.get("band")), seconds(edges)]
        cells += [
            seconds(phases.get("contour")),
            seconds(row["engine"]) + once,
            megabytes(row["memory"]),
        ]
        cells += [
            count(row["active"]),
            count(row["triangles"]),
            error(row["mean"]),
            error(row["max"]),
        ]
        cells += [error(row["missing"]), row["creases"], count(row["pairs"]), count(row["bad"])]
        rows.append([f"**{title}**" if r["method"] == "exocarp" else title, *cells])
    columns = [
        "method",
        "hierarchy, s",
        "band, s",
        "edges / offset, s",
        "contour, s",
        "engine, s",
        "memory, MB",
    ]
    columns += [
        "active voxels",
        "triangles",
        "mean",
        "max",
        "missing",
        "creases, %",
        "crossing pairs",
        "non-manifold",
    ]
    text += table(columns, rows)
    for name, title in pictures:
        text += f"\n*{title[0].upper() + title[1:]}.* {CAPTION}\n\n![{title}]({name})\n"
    return text


def pictures(case, directory):
    """The cross-sections of a report that are kept, a picture each, the methods side by side."""
    key = (case["model"], case["distance"], 256)
    try:
        page = open(case["report"]).read() if key in PICTURES else ""
    except OSError:
        return []
    style = re.search(r"<style>(.*?)</style>", page, re.S)
    kept = []
    for figure in PICTURES.get(key, ()):
        found = re.search(rf'<figure id="fig-{figure}">(.*?)</figure>', page, re.S)
        if not found:
            continue
        panels = re.findall(
            r'<svg viewBox="0 0 ([\d.]+) ([\d.]+)".*?aria-label="(.*?) at: .*?>(.*?)</svg>',
            found[1],
            re.S,
        )
        title = re.search(r"<h2>(.*?)</h2>", found[1])[1]
        name = f"{case['model']}{case['distance'].replace('%', '').replace('-', '-minus-')}-{figure}.svg"
        (directory / name).write_text(joined(panels, style[1] if style else ""))
        kept.append((name, title.lower()))
    return kept


def joined(panels, style):
    """Panels of a report side by side, in rows of three, as one SVG."""
    width, height = (float(x) for x in panels[0][:2])
    columns = min(3, len(panels))
    rows = -(-len(panels) // columns)
    size = (columns * (width + GAP) - GAP, rows * (height + FOOT))
    parts = []
    for k, (_, _, title, content) in enumerate(panels):
        x, y = (k % columns) * (width + GAP), (k // columns) * (height + FOOT)
        body = re.sub(r'd="([^"]*)"', lambda d: f'd="{seen(d[1], width, height)}"', content)
        parts.append(
            f'<svg x="{x:g}" y="{y:g}" width="{width:g}" height="{height:g}" viewBox="0 0 {width:g} {height:g}">{body}</svg>'
        )
        parts.append(f'<text x="{x:g}" y="{y + height + 18:g}" class="name">{title}</text>')
    own = "\n".join(
        rule for rule in style.split("\n") if re.match(r"\.(name|scale|tick|value|faint)\b", rule)
    )
    view = f'viewBox="0 0 {size[0]:g} {size[1]:g}" width="{size[0]:g}"'
    font = 'font-family="Liberation Sans, Arial, sans-serif"'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {view} {font}><style>{own}</style>{"".join(parts)}</svg>\n'


def seen(path, width, height):
    """Lines of a path of single segments that can be in view; other paths as they are."""
    lines = re.findall(r"M([-\d.]+) ([-\d.]+)L([-\d.]+) ([-\d.]+)(?=M|$)", path)
    if "".join(f"M{a} {b}L{c} {d}" for a, b, c, d in lines) != path:
        return path
    inside = []
    for line in lines:
        a, b, c, d = map(float, line)
        if max(a, c) >= 0 and min(a, c) <= width and max(b, d) >= 0 and min(b, d) <= height:
            inside.append("M{} {}L{} {}".format(*line))
    return "".join(inside)


def figures(data):
    """The paragraph of README.md: the largest case beside its peers."""
    sound = lambda case: all(method_row(r) for r in case["result"]["results"])
    cases = [case for case in data["peers"] if sound(case) and not case["distance"].startswith("-")]
    if not cases:
        return ""
    case = max(cases, key=lambda c: method_row(c["result"]["results"][0])["triangles"])
    rows = {r["method"]: method_row(r) for r in case["result"]["results"]}
    own = rows["exocarp"]
    text = f"{case['model']} ({count(case['result']['input_triangles'])} triangles) grown by {case['distance']} "
    text += f"at resolution {case['resolution']} on {data['machine']['cores']} cores: {seconds(own['engine'])} s, "
    text += f"{megabytes(own['memory'])} MB, {count(own['triangles'])} triangles, a mean error of {error(own['mean'])} "
    text += f"voxels, {own['pairs'] or 'no'} intersecting pairs."
    names = [m for m in ("openvdb-wide", "meshlib-sharp") if m in rows]
    others = [f"{TITLES[m]} took {seconds(rows[m]['engine'])} s" for m in names]
    text += f" In turn with it {', '.join(others)}." if others else ""
    text += f" ({data['date']}, {data['machine']['cpu']}.) [docs/benchmarks.md](docs/benchmarks.md) has all figures."
    return textwrap.fill(text, 100, break_long_words=False, break_on_hyphens=False)


def write_figures(data, path):
    """Replaces the figures of README.md, which stand between two marks."""
    text = path.read_text()
    before, rest = text.split(FIRST_MARK, 1)
    _, after = rest.split(LAST_MARK, 1)
    path.write_text(f"{before}{FIRST_MARK}\n{figures(data)}\n{LAST_MARK}{after}")


def save(path, text):
    """Writes a page, wrapped as all prose is, without a blank line after another."""
    text = re.sub(r"\n{3,}", "\n\n", text)
    path.write_text("\n".join(wrap.wrapped(text.split("\n"), wrap.WIDTH)))


def write(data, docs):
    """Writes all pages, and the pictures of the comparison."""
    docs.mkdir(parents=True, exist_ok=True)
    times, quality = peers(data)
    text = BENCHMARKS.format(
        head=head(data),
        runs=data["runs"],
        once=5 if data["quick"] else 25,
        times=times,
        quality=quality,
        growth=growth(data),
        threads=threads(data),
        streaming=streaming(data),
        noisy=noisy(data),
        deviate="2e-5",
        single="One run each." if data["quick"] else "",
        thickening=thickening(data),
    )
    save(docs / "benchmarks.md", text)
    save(docs / "paper-tables.md", PAPER.format(head=head(data), tables=data["paper"].rstrip()))
    directory = docs / "compare"
    directory.mkdir(parents=True, exist_ok=True)
    for old in [*directory.glob("*.png"), *directory.glob("*.svg")]:
        old.unlink()
    cases = [compare_case(case, pictures(case, directory)) for case in data["peers"]]
    save(directory / "README.md", COMPARE.format(head=head(data), cases="\n".join(cases)))
