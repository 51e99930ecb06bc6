# SPDX-License-Identifier: BSD-3-Clause
"""The zoo's results as a summary, a CSV table and one HTML page that needs nothing else."""
import csv
import html

COLUMNS = (
    ("robot", "name"), ("source", "source"), ("kind", "kind"), ("variables", "variables"), ("triangles", "triangles"),
    ("info", "info"), ("info s", "info_s"), ("SRDF", "srdf"), ("SRDF read", "srdf_read"), ("notices", "notices"),
    ("pairs", "pairs"), ("pairs s", "pairs_s"), ("findings", "findings"), ("states", "states"), ("free, own SRDF", "free_own"),
    ("free, new SRDF", "free"), ("free, more states", "free_more"), ("first pass us", "check_first_us"), ("us a state", "check_us"), ("own SRDF us", "check_own_us"),
    ("spherize", "spherize"), ("spherize s", "spherize_s"), ("spheres", "spheres"), ("plan", "plan"), ("plan s", "plan_s"),
    ("planner s", "plan_planner_s"), ("audit", "plan_audit"), ("audit s", "plan_audit_s"), ("plan, own SRDF", "plan_own"),
    ("audit, own SRDF", "plan_own_audit"), ("oracle", "oracle"), ("oracle states", "oracle_states"),
    ("oracle contacts", "oracle_contacts"), ("booleans differ", "oracle_booleans_count"), ("touching within 1e-6", "oracle_grazing"),
    ("distances differ", "oracle_distances_count"), ("largest m", "oracle_largest"),
)


def reason(row):
    """Why a stage did not end well, in the words of leeway."""
    parts = []
    for key, value in row.items():
        if key.endswith("_message") or key in ("fault", "surprise"):
            parts.append(f"{key.removesuffix('_message')}: {value}")
    for extra in row.get("more_srdfs", []):
        if extra["read"] != "yes":
            parts.append(f"{extra['srdf']}: {extra['read']}")
    for key in ("plan_why", "plan_own_why"):
        if row.get(key):
            parts.append(f"{key.removesuffix('_why')}: {row[key]['text']}")
    if str(row.get("oracle", "")).startswith(("not comparable", "leeway")):
        parts.append(f"oracle: {row['oracle']}")
    return "; ".join(parts)


def summary(rows):
    robots = [row for row in rows if row["kind"] == "robot"]
    read = [row for row in robots if row.get("info") == "yes"]
    srdfs = [row["srdf_read"] for row in rows if row.get("srdf_read")]
    srdfs += [extra["read"] for row in rows for extra in row.get("more_srdfs", [])]
    # A plan needs two free states.
    asked = [row for row in read if row.get("plan") and row["plan"] != "fewer than two free states"]
    valid = [row for row in asked if row.get("plan_audit") == "valid"]
    compared = [row for row in read if "oracle_states" in row]
    return {
        "descriptions": len(rows),
        "robots": len(robots),
        "read": len(read),
        "not_read": {row["name"]: row.get("info_message", row.get("info")) for row in robots if row.get("info") != "yes"},
        "srdfs": len(srdfs),
        "srdfs_read": srdfs.count("yes"),
        "two_free_states": len(asked),
        "plans_found": sum(row["plan"] == "found" for row in asked),
        "plans_valid": len(valid),
        "plans_disconnected": sum("disconnected" in row.get("plan_why", {}).get("verdict", "") for row in asked),
        "plans_of_another_planner": sum(row.get("plan_why", {}).get("verdict") == "another planner" for row in asked),
        "plans_missing": {row["name"]: reason(row) or row["plan"] for row in asked if row.get("plan_audit") != "valid"},
        "own_srdf_plans": sum("plan_own" in row for row in read),
        "own_srdf_plans_valid": sum(row.get("plan_own_audit") == "valid" for row in read),
        "compared": len(compared),
        "compared_states": sum(row["oracle_states"] for row in compared),
        "booleans_that_differ": sum(row["oracle_booleans_count"] for row in compared),
        "distances_that_differ": sum(row["oracle_distances_count"] for row in compared),
        "time_limits": sorted(f"{row['name']}: {key}" for row in rows for key, value in row.items() if value == "time limit"),
        "crashes": sorted(f"{row['name']}: {key}" for row in rows for key, value in row.items()
                          if isinstance(value, str) and (value.startswith("crash") or key == "fault")),
    }


def share(part, whole):
    return f"{part} of {whole}" + (f" ({100 * part / whole:.0f} %)" if whole else "")


def summary_text(s):
    lines = [
        f"{s['descriptions']} descriptions, {s['robots']} with joints and collision geometry",
        f"read: {share(s['read'], s['robots'])}; SRDFs read: {share(s['srdfs_read'], s['srdfs'])}",
        f"plan between two free states, found and audited valid: {share(s['plans_valid'], s['two_free_states'])}; of the others "
        f"{s['plans_disconnected']} are disconnected, {s['plans_of_another_planner']} connected by another planner",
        f"with the SRDF that came with the robot: {share(s['own_srdf_plans_valid'], s['own_srdf_plans'])}",
        f"pinocchio + coal: {s['compared_states']} states of {s['compared']} robots, {s['booleans_that_differ']} booleans and "
        f"{s['distances_that_differ']} distances differ",
    ]
    for title, key in (("not read", "not_read"), ("no valid plan", "plans_missing")):
        lines += [f"{title}: {name}: {text}" for name, text in s[key].items()]
    for title, key in (("time limit", "time_limits"), ("crash", "crashes")):
        lines += [f"{title}: {text}" for text in s[key]]
    return "\n".join(lines)


def cell(value):
    if value is None:
        return ""
    return f"{value:.3g}" if isinstance(value, float) else str(value)


def write_csv(path, rows, zoo):
    """Files are named from the zoo's folder on, which is another one on each machine."""
    with open(path, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([title for title, _ in COLUMNS] + ["reason"])
        writer.writerows([[cell(row.get(key)) for _, key in COLUMNS] + [reason(row).replace(f"{zoo}/", "")] for row in rows])


def mood(key, value):
    if value in ("found", "valid", "agrees") or (key in ("info", "srdf_read", "spherize") and value == "yes"):
        return "good"
    if value in ("INVALID", "DIFFERS", "time limit", "error", "not found", "refused") or str(value).startswith("crash"):
        return "bad"
    return ""


STYLE = """body { font: 13px/1.4 system-ui, sans-serif; margin: 1.5em; color: #222 } table { border-collapse: collapse }
td, th { border: 1px solid #ddd; padding: 2px 6px; text-align: right; white-space: nowrap } th { position: sticky; top: 0;
background: #f4f4f4; cursor: pointer } td:first-child, td:last-child, th:first-child { text-align: left } td:last-child {
white-space: normal; min-width: 40em } .good { background: #e3f5e3 } .bad { background: #fbe0dd } pre { white-space: pre-wrap }"""

# A click on a column's title sorts by it.
SCRIPT = """document.querySelectorAll('th').forEach((head, column) => head.onclick = () => {
  const body = document.querySelector('tbody'), rows = [...body.rows], up = head.dataset.up = head.dataset.up === '1' ? '0' : '1';
  const text = row => row.cells[column].textContent, key = row => isNaN(text(row)) || text(row) === '' ? text(row) : +text(row);
  rows.sort((a, b) => (key(a) > key(b) ? 1 : key(a) < key(b) ? -1 : 0) * (up === '1' ? 1 : -1));
  body.append(...rows); });"""


def write_html(path, result):
    rows = []
    for row in result["rows"]:
        cells = [f'<td class="{mood(key, row.get(key))}">{html.escape(cell(row.get(key)))}</td>' for _, key in COLUMNS]
        rows.append(f"<tr>{''.join(cells)}<td>{html.escape(reason(row))}</td></tr>")
    heads = "".join(f"<th>{html.escape(title)}</th>" for title in [title for title, _ in COLUMNS] + ["reason"])
    told = "\n".join(f"{key}: {value}" for key, value in result["provenance"].items())
    path.write_text(f"""<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>leeway: the zoo</title><style>{STYLE}</style></head><body>
<h1>The zoo</h1>
<pre>{html.escape(summary_text(result['summary']))}</pre>
<table><thead><tr>{heads}</tr></thead><tbody>
{chr(10).join(rows)}
</tbody></table>
<h2>Provenance</h2><pre>{html.escape(told)}</pre>
<script>{SCRIPT}</script></body></html>
""")
