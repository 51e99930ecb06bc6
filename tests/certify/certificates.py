#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Certificates against both checkers, and mutated ones against a judge that samples.

    PYTHONPATH=build/python certificates.py --leeway build/bin/leeway --checker build/bin/check_certificate [--worlds N] [--mutations N] [--seed S]

honest   leeway plans and proves motions of random robots (paths, timed trajectories with tolerance): both checkers accept them, in the same words.
mutated  numbers, words of the proof, pairs, order and length are changed at random; two in five are stretched instead: a claim is made bolder
         as long as it is accepted. Both checkers give one verdict. Accepted ones are sampled: the judge has kinematics of its own (4 x 4 matrices) and takes distances of shapes from leeway's Python package.

Exit status 1: an honest certificate is refused, the checkers disagree, or an accepted claim is false."""
import argparse
import copy
import hashlib
import importlib.util
import pathlib
import random
import struct
import subprocess
import sys
import tempfile

import worlds

HERE = pathlib.Path(__file__).resolve().parent
SOURCE = HERE.parents[1] / "planners" / "certify" / "check_certificate.py"
spec = importlib.util.spec_from_file_location("check_certificate", SOURCE)
check = importlib.util.module_from_spec(spec)
spec.loader.exec_module(check)
sys.setrecursionlimit(10000)


# ---- the binary form, from the content that check_certificate.py reads

def count(n):
    out = bytearray()
    while n >= 128:
        out.append(n & 127 | 128)
        n >>= 7
    return bytes(out) + bytes([n])


def reals(values):
    values = list(values)
    return struct.pack(f"<{len(values)}d", *values)


def words(text):
    data = text.encode()
    return count(len(data)) + data


def listed(items, write):
    return count(len(items)) + b"".join(write(item) for item in items)


def link_bytes(link):
    out = words(link["name"]) + words(link["joint"]) + count(link["parent"]) + reals(link["origin"]) + bytes([link["type"]])
    if link["type"] != check.FIXED:
        out += reals(link["axis"]) + count(0 if link["variable"] is None else link["variable"] + 1) + reals([link["multiplier"], link["offset"]])
    return out


def shape_bytes(shape):
    head = words(shape["source"]) + bytes([shape["kind"], 2 if shape["solid"] else 0]) + reals([shape["radius"], shape["height"]])
    return head + count(len(shape["numbers"])) + reals(shape["numbers"]) + listed(shape["corners"], count)


def placed_bytes(placed):
    return count(placed["owner"]) + count(placed["shape"]) + reals(placed["pose"])


def binary(c):
    out = b"LWCERT1\n" + reals([c["min_d"]]) + bytes([c["claims"]])
    out += listed(c["sources"], lambda s: words(s["name"]) + bytes.fromhex(s["sha256"]))
    out += listed(c["variables"], lambda v: words(v["name"]) + reals([v["lower"], v["upper"], v["tolerance"]]))
    out += listed(c["links"], link_bytes) + listed(c["shapes"], shape_bytes) + listed(c["bodies"], placed_bytes)
    out += listed(c["objects"], words) + listed(c["obstacles"], placed_bytes)
    out += listed(c["allowed"], lambda r: bytes([r["object"]]) + count(r["a"]) + count(r["b"]) + words(r["reason"]))
    out += listed(c["margins"], lambda r: bytes([r["object"]]) + count(r["a"]) + count(r["b"]) + reals([r["margin"]]))
    out += hashlib.sha256(out).digest()
    out += count(len(c["pieces"])) + reals(c["start"]) + b"".join(bytes([len(p)]) + b"".join(map(reals, p)) for p in c["pieces"])
    out += bytes.fromhex(c["proof"])
    return out + hashlib.sha256(out).digest()


# ---- verdicts

def by_python(data):
    try:
        content = check.Reader(data).content()
        return 0, check.Proof(check.Model(content), content).run()
    except check.Rejected as error:
        return 1, str(error)
    except (check.Damaged, KeyError, TypeError, ValueError, IndexError, OverflowError, RecursionError, struct.error) as error:
        return 2, str(error)


def by_digest(data):
    """Why a file cannot be read; empty if it can."""
    try:
        check.Reader(data).content()
        return ""
    except (check.Damaged, ValueError, struct.error) as error:
        return str(error)


def by_c(checker, file):
    run = subprocess.run([checker, file], capture_output=True, text=True, check=False)
    return run.returncode, run.stdout.strip() + run.stderr.strip()


# ---- honest certificates

def honest(given, folder, rng):
    """Two certificates of one random world: of a path, and of a timed trajectory with a tolerance; fewer if no motion is found."""
    worlds.write_robot(folder, rng)
    worlds.write_scene(folder, rng)
    model = ["--robot", "robot.urdf", "--scene", "scene.yaml", "--no-cache", "--joint-limits", "limits.yaml"]
    plan = [given.leeway, "plan", *model, "--start", "random", "--goal", "random", "--seed", str(rng.randint(1, 10 ** 6)), "--time", "2", "--min-d",
        str(rng.choice([0, 0.001, 0.005])), "--out", "path.yaml", "--trajectory", "trajectory.yaml", "--certificate", "path.lwc"]
    audit = [given.leeway, "audit", *model, "--trajectory", "trajectory.yaml", "--tolerance", "0.001", "--certificate", "trajectory.lwc"]
    made = []
    for command, name in ((plan, "path.lwc"), (audit, "trajectory.lwc")):
        run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
        if (folder / name).exists():
            made.append((folder / name).read_bytes())
        elif run.returncode == 0:
            raise AssertionError(f"no certificate, and status 0: {command}: {run.stderr}")
    return made


# ---- mutations

def change(x, rng):
    return rng.choice([x + rng.gauss(0, 10 ** rng.uniform(-6, -0.5)), -x, x * rng.uniform(0.5, 2), 0.0, rng.uniform(-2, 2)])


def mutate_model(c, rng):
    kind = rng.randrange(12)
    some = lambda items: items[rng.randrange(len(items))] if items else None  # noqa: E731
    if kind == 0:
        c["min_d"] = abs(change(c["min_d"], rng))
    elif kind == 1:
        some(c["variables"])["tolerance"] = abs(rng.gauss(0, 10 ** rng.uniform(-4, 0)))
    elif kind in (2, 3):
        link = some(c["links"])
        field = rng.choice(["origin", "axis"] if link["type"] else ["origin"])
        link[field][rng.randrange(3)] = change(link[field][0], rng)
    elif kind == 4:
        link = some([link for link in c["links"] if link["type"]])
        if link:
            link[rng.choice(["multiplier", "offset"])] = change(1, rng)
    elif kind == 5:
        shape = some(c["shapes"])
        if shape["numbers"] and rng.random() < 0.7:
            i = rng.randrange(len(shape["numbers"]))
            shape["numbers"][i] = change(shape["numbers"][i], rng)
        else:
            field = rng.choice(["radius", "height"])
            shape[field] = abs(change(shape[field], rng))
    elif kind in (6, 7):
        placed = some(c["bodies"] if kind == 6 else c["obstacles"])
        if placed:
            placed["pose"][rng.randrange(7)] += rng.gauss(0, 10 ** rng.uniform(-4, -0.3))
    elif kind == 8 and c["allowed"]:
        c["allowed"].pop(rng.randrange(len(c["allowed"])))
    elif kind == 9:
        c["margins"].append({"object": 1, "a": rng.randrange(len(c["links"])), "b": rng.randrange(max(1, len(c["objects"]))), "margin": rng.uniform(0, 0.1)})
    elif kind == 10:
        row = rng.choice(rng.choice(c["pieces"]))
        i = rng.randrange(len(row))
        row[i] = change(row[i], rng)
    else:
        c[rng.choice(["bodies", "obstacles"])].reverse()


def mutate_proof(c, rng):
    proof = bytearray.fromhex(c["proof"])
    for _ in range(rng.choice([1, 1, 1, 3])):
        i, kind = rng.randrange(len(proof)), rng.randrange(6)
        if kind == 0:
            proof[i] = rng.randrange(256)
        elif kind == 1:
            proof[i] = rng.randrange(7)
        elif kind == 2:
            del proof[i:i + rng.randint(1, 4)]
        elif kind == 3:
            proof[i:i] = bytes(rng.randrange(7) for _ in range(rng.randint(1, 3)))
        elif kind == 4:
            proof = proof[i:] + proof[:i]
        else:
            k = rng.randrange(len(proof))
            proof[i], proof[k] = proof[k], proof[i]
        if not proof:
            proof = bytearray(b"\0")
    c["proof"] = proof.hex()


def stretched(data, rng, accepts):
    """The boldest claim that is accepted along one direction: a distance, tolerance, place of a body or obstacle is moved, or the motion made
    longer, as far as that holds. Windows are larger than the writer would make them then."""
    c = check.Reader(data).content()
    kind, sign = rng.randrange(6), rng.choice([-1, 1])
    variable, axis = rng.randrange(len(c["variables"])), rng.randrange(3)
    body, obstacle = rng.randrange(len(c["bodies"])), rng.randrange(max(1, len(c["obstacles"])))

    def moved(by):
        m = copy.deepcopy(c)
        if kind == 0 or (kind == 3 and not c["obstacles"]):
            m["min_d"] += by
        elif kind == 1:
            m["variables"][variable]["tolerance"] += by
        elif kind == 4:
            for one in m["variables"]:
                one["tolerance"] += by
        elif kind == 5:
            m["pieces"] = [[[s + (1 + 4 * by) * (x - s) for x, s in zip(p, c["start"])] for p in piece] for piece in c["pieces"]]
        else:
            (m["bodies"][body] if kind == 2 else m["obstacles"][obstacle])["pose"][axis] += sign * by
        return binary(m)

    low, high = 0.0, 1.0
    for _ in range(16):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if accepts(moved(middle)) else (low, middle)
    return moved(low)


def mutated(data, rng):
    if rng.random() < 0.1:  # bytes of the file, with digests that fit no longer
        changed = bytearray(data)
        changed[rng.randrange(len(changed))] ^= 1 << rng.randrange(8)
        return bytes(changed)
    c = copy.deepcopy(check.Reader(data).content())
    for _ in range(rng.choice([1, 1, 2])):
        mutate_model(c, rng) if rng.random() < 0.6 else mutate_proof(c, rng)
    return binary(c)


# ---- the run

def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--leeway", required=True)
    options.add_argument("--checker", required=True)
    options.add_argument("--worlds", type=int, default=20)
    options.add_argument("--mutations", type=int, default=1000)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--c-alone", action="store_true", help="the slower checker in Python is not asked")
    options.add_argument("--no-judge", action="store_true", help="without the leeway package: accepted ones are not sampled")
    given = options.parse_args()
    given.leeway = str(pathlib.Path(given.leeway).resolve())
    rng, made, wrong = random.Random(given.seed), [], []
    print(f"seed {given.seed}")
    with tempfile.TemporaryDirectory() as root:
        for i in range(given.worlds):
            folder = pathlib.Path(root) / str(i)
            folder.mkdir()
            made += honest(given, folder, rng)
        file = pathlib.Path(root) / "c.lwc"

        def accepted_by_c(data):
            file.write_bytes(data)
            return by_c(given.checker, file)[0] == 0

        for data in made:
            file.write_bytes(data)
            c, python = by_c(given.checker, file), by_python(data)
            if c != python or c[0] != 0:
                wrong.append(f"honest: C {c}, Python {python}")
            content = check.Reader(data).content()
            again = check.Reader(binary(content)).content()
            if {**again, "model_sha256": ""} != {**content, "model_sha256": ""}:
                wrong.append("the test cannot write the format")
        tally = {0: 0, 1: 0, 2: 0}
        if not given.no_judge:
            import judge
        for i in range(given.mutations):
            data = rng.choice(made)
            data = mutated(data, rng) if rng.random() < 0.6 else stretched(data, rng, accepted_by_c)
            file.write_bytes(data)
            c = by_c(given.checker, file)
            python = c if given.c_alone else by_python(data)
            digest = "SHA-256" in by_digest(data)
            if c[0] not in tally or (c[0] != python[0] and not digest):
                wrong.append(f"mutation {i}: C {c}, Python {python}")
                continue
            tally[c[0]] += 1
            if c[0] == 0 and not given.no_judge and not digest:
                false = judge.contradiction(check.Reader(data).content(), rng)
                if false:
                    wrong.append(f"mutation {i}: accepted, and {false}")
    print(f"{len(made)} honest certificates; {given.mutations} mutations: {tally[0]} accepted, {tally[1]} rejected, {tally[2]} damaged; {len(wrong)} wrong")
    for line in wrong[:10]:
        print(f"  {line}")
    return int(bool(wrong) or len(made) < given.worlds)


if __name__ == "__main__":
    sys.exit(main())
