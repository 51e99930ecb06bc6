# SPDX-License-Identifier: BSD-3-Clause
"""Certificates written anew from the content that check_certificate.py reads, and changed: at random, or bolder as long as they are accepted."""
import hashlib
import pickle
import struct


# ---- the binary form

def copied(content):
    """A deep copy; pickle makes it in a fifth of the time of copy.deepcopy()."""
    return pickle.loads(pickle.dumps(content, -1))


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
    if link["type"] != 0:
        out += reals(link["axis"]) + count(0 if link["variable"] is None else link["variable"] + 1) + reals([link["multiplier"], link["offset"]])
    return out


def shape_bytes(shape):
    head = words(shape["source"]) + bytes([shape["kind"], 2 if shape["solid"] else 0]) + reals([shape["radius"], shape["height"]])
    return head + count(len(shape["numbers"])) + reals(shape["numbers"]) + listed(shape["corners"], count)


def placed_bytes(placed):
    return count(placed["owner"]) + count(placed["shape"]) + reals(placed["pose"])


def binary(c):
    out = b"LWCERT2\n" + bytes([c["claims"]])
    out += listed(c["variables"], lambda v: words(v["name"]) + reals([v["lower"], v["upper"]]))
    out += listed(c["links"], link_bytes) + listed(c["shapes"], shape_bytes) + listed(c["bodies"], placed_bytes)
    out += listed(c["objects"], words) + listed(c["obstacles"], placed_bytes)
    out += listed(c["allowed"], lambda r: bytes([r["object"]]) + count(r["a"]) + count(r["b"]) + words(r["reason"]))
    out += listed(c["margins"], lambda r: bytes([r["object"]]) + count(r["a"]) + count(r["b"]) + reals([r["margin"]]))
    out += hashlib.sha256(out).digest()
    out += reals([c["min_d"]]) + listed(c["sources"], lambda s: words(s["name"]) + bytes.fromhex(s["sha256"]))
    out += b"".join(count(v["track"]) + reals(v[name] for name in ("tolerance", "lag", "spread", "since")) for v in c["variables"])
    out += reals([c["begin"]]) + count(len(c["pieces"])) + reals(c["start"])
    out += b"".join(bytes([len(p)]) + reals([s]) + b"".join(map(reals, p)) for s, p in zip(c["seconds"], c["pieces"]))
    out += bytes.fromhex(c["proof"])
    return out + hashlib.sha256(out).digest()


# ---- mutations

def change(x, rng):
    return rng.choice([x + rng.gauss(0, 10 ** rng.uniform(-6, -0.5)), -x, x * rng.uniform(0.5, 2), 0.0, rng.uniform(-2, 2)])


def mutate_model(c, rng):
    kind = rng.randrange(14)
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
    elif kind == 11:
        k = rng.randrange(len(c["seconds"]))
        c["seconds"][k] = rng.choice([0, c["seconds"][k] * rng.uniform(0.1, 3), rng.uniform(0, 2)])
    elif kind == 12:
        variable = some(c["variables"])
        variable[rng.choice(["lag", "spread"])] = rng.choice([0, abs(rng.gauss(0, 10 ** rng.uniform(-3, 0)))])
        variable["track"] = rng.randrange(3)
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


def boldest(make, accepts, steps, high=1.0):
    """make( x ) of the largest x in [0, high] found by bisection that is accepted; make( 0 ) if there is none."""
    low = 0.0
    for _ in range(steps):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if accepts(make(middle)) else (low, middle)
    return make(low)


def stretched(c, rng, accepts, steps=12):
    """The boldest claim that is accepted along one direction: a distance, margin, tolerance, place of a body or obstacle is moved, or the motion made
    longer, as far as that holds. Windows are larger than the writer would make them then."""
    kind, sign = rng.randrange(7), rng.choice([-1, 1])
    if any(v["lag"] for v in c["variables"]) and rng.random() < 0.4:
        kind = rng.choice([7, 8])
    variable, axis = rng.randrange(len(c["variables"])), rng.randrange(3)
    body, obstacle = rng.randrange(len(c["bodies"])), rng.randrange(max(1, len(c["obstacles"])))
    if kind in (3, 6) and not c["obstacles"]:
        kind = 0

    def moved(by):
        m = copied(c)
        if kind == 0:
            m["min_d"] += by
        elif kind == 1:
            m["variables"][variable]["tolerance"] += by
        elif kind == 4:
            for one in m["variables"]:
                one["tolerance"] += by
        elif kind == 7:
            for one in m["variables"]:
                one["lag"] *= 1 + 30 * by
        elif kind == 8:
            m["variables"][variable]["spread"] += by
        elif kind == 5:
            m["pieces"] = [[[s + (1 + 4 * by) * (x - s) for x, s in zip(p, c["start"])] for p in piece] for piece in c["pieces"]]
        elif kind == 6:
            m["margins"].append({"object": 1, "a": c["bodies"][body]["owner"], "b": c["obstacles"][obstacle]["owner"], "margin": by})
        else:
            (m["bodies"][body] if kind == 2 else m["obstacles"][obstacle])["pose"][axis] += sign * by
        return binary(m)

    return boldest(moved, accepts, steps)


def flipped(data, model_end, rng):
    """One bit changed, the digest at the end made to fit or not. Returns the bytes, and whether all digests fit."""
    changed, at = bytearray(data), rng.randrange(len(data) - 32)
    changed[at] ^= 1 << rng.randrange(8)
    if rng.random() < 0.5:
        return bytes(changed), False
    return bytes(changed[:-32]) + hashlib.sha256(changed[:-32]).digest(), at >= model_end


def mutated(c, rng):
    c = copied(c)
    for _ in range(rng.choice([1, 1, 2])):
        mutate_model(c, rng) if rng.random() < 0.6 else mutate_proof(c, rng)
    return binary(c)
