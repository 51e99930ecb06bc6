#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Plants mistakes in copies of the checkers, one at a time, and sees whether certificates.py finds each.

    PYTHONPATH=build/python plants.py --leeway build/bin/leeway [--compiler cc] [--mutations N] [--name PART]

A mistake in the C checker is judged without the one in Python: the judge alone must find an accepted claim that is false, or an honest one that is refused.
Mistakes that make no claim false, and those in Python, are found where the checkers differ. Exit status 1: one is not found."""
import argparse
import pathlib
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
CERTIFY = HERE.parents[1] / "planners" / "certify"

# name, text of check_certificate.c, its replacement
IN_C = [
    ("path bound of a", "- x.path - y.path", "- y.path"),
    ("path bound of b", "- x.path - y.path", "- x.path"),
    ("path of shifts", "s.path += e, below_sum += e;", "below_sum += e;"),
    ("radius of a sphere", "gap - x.radius - y.radius", "gap - y.radius"),
    ("tolerance", "w->rest[j] = rest + timely[j];", "w->rest[j] = rest;"),
    ("begin of a window", "for ( int s = -1; s <= 1; s += 2 )", "for ( int s = 1; s <= 1; s += 2 )"),
    ("end of a window", "for ( int s = -1; s <= 1; s += 2 )", "for ( int s = -1; s < 1; s += 2 )"),
    ("second order of a turn", "( rest + e * e / 2 )", "( rest )"),
    ("second order, a half of it", "( rest + e * e / 2 )", "( rest + e * e / 4 )"),
    ("turns that carry others", "+ e * below_sum;", ";"),
    ("shifts that are carried", "s.path += e, below_sum += e;", "s.path += e;"),
    ("rest of a curve", "rest = fmax( rest, fabs(", "rest = fmin( rest, fabs("),
    ("rest of a", "room - x.rest - y.rest", "room - y.rest"),
    ("rest of b", "room - x.rest - y.rest", "room - x.rest"),
    ("first order of a", "add( n, scale( s, cross( n, x.turn ) ) )", "n"),
    ("shift of first order", "+ s * dot( n, x.shift )", ""),
    ("min_d", "object, 0, 0, 0, min_d }", "object, 0, 0, 0, 0 }"),
    ("margin", "p.need += margin;", ""),
    ("pair of links", "j = i + 1; j < body_count", "j = i + 2; j < body_count"),
    ("last obstacle", "j < obstacle_count && ( claims & 1 )", "j + 1 < obstacle_count && ( claims & 1 )"),
    ("pairs of later pieces", "piece > 0 && !p->moves", "piece > 0"),
    ("later half of a window", "check( p, a, b, degree, w->halves[1] )", "check( p, a, b, degree, w->halves[0] )"),
    ("second half of a part", "divided->range = second_half( s->ranges, i )", "divided->range = i + 1"),
    ("halves of a solid", "unbounded( s ) || s->solid ||", "unbounded( s ) ||"),
    ("multiplier of a speed", "double speed = l->multiplier * w->speed", "double speed = w->speed"),
    ("multiplier of a rest", "rest = fabs( l->multiplier ) * tube", "rest = tube"),
    ("offset", "checked( l->offset + (", "checked( 0 + ("),
    ("radius of triangles", "fmax( dot( corner( s, e, 1 ), n ), dot( corner( s, e, 2 ), n ) ) ) + s->radius * size", "fmax( dot( corner( s, e, 1 ), n ), dot( corner( s, e, 2 ), n ) ) )"),
    ("third corner", "dot( corner( s, e, 2 ), n ) ) ) + s->radius", "dot( corner( s, e, 1 ), n ) ) ) + s->radius"),
    ("balls of a range", "sub( a->middle, r->middle ) ) + a->radius, norm( sub( b->middle, r->middle ) ) + b->radius", "sub( a->middle, r->middle ) ), norm( sub( b->middle, r->middle ) )"),
    ("box of a range", "fmax( a_high.y, b_high.y )", "a_high.y"),
    ("inside of a half-space", "if ( b->shape->kind == PLANE ) gap = fabs( gap );", "if ( unbounded( b->shape ) ) gap = fabs( gap );"),
    ("side of a half-space", "b->shape->kind == PLANE && dot( n, y.pose.c[2] ) > 0", "dot( n, y.pose.c[2] ) > 0"),
    ("axis of unit length", "l->axis = unit( read_vec() )", "l->axis = read_vec()"),
    ("length of a direction", "scale( 1 / norm( direction ), direction )", "direction"),
    ("lag", "( p->late ? late[l->variable] : 0 )", "0"),
    ("pairs of several tracks", "p.late |= track != NONE && track != variables[v].track,", ""),
    ("track of a variable", "track != NONE && track != variables[v].track", "0"),
    ("spread", "v->tolerance + v->spread * fmax( 0, until - v->since )", "v->tolerance"),
    ("spread at the end of a piece", "fmin( times[piece + 1] + most_lag, times[piece_count] )", "times[piece]"),
    ("origin of an axis", "s.shift = add( s.shift, scale( speed, cross( origin, axis ) ) );", ""),
]
# They make no claim false, or so seldom that no sample is: the checkers then differ
IN_C_ALONE = [
    ("pieces before within the lag", "times[i + 1] < times[piece] - v->lag - 1e-6", "times[i + 1] < times[piece]"),
    ("pieces behind within the lag", "times[i] > times[piece + 1] + v->lag + 1e-6", "times[i] > times[piece + 1]"),
    ("speed of a curve", "(double)( rows[i + 1] - rows[i] ) * step", "step"),
    ("bytes after the proof", 'if ( at != file_size ) damaged( "bytes follow the proof" );', ""),
    ("pairs that are counted and not there", 'if ( by_spheres != 0 ) damaged( "it counts more pairs than there are" );', ""),
]
IN_PYTHON = [
    ("digest", 'need(self.take(32).hex() == wanted, "a SHA-256 does not fit")', "self.take(32)"),
    ("digest of the whole", '        model["proof"] = self.take(len(self.data) - self.at - 32).hex()\n        self.digest()', '        model["proof"] = self.take(len(self.data) - self.at - 32).hex()'),
    ("digest of a source", 'raise Rejected(f"the certificate was not made from {name}")', "pass"),
    ("tolerance", "+ tubes[0][j]\n", "\n"),
    ("lag", "(self.tubes[1][link.variable] if late else 0)", "0"),
    ("several tracks", "for j in pair.between & moving}) > 1", "for j in pair.between & moving}) > 2"),
    ("second order of a turn", "(free + e * e / 2)", "free"),
    ("pair of links", "self.bodies[i + 1:]", "self.bodies[i + 2:]"),
    ("path bound", "- path_a - path_b", "- path_b"),
]


def planted(source, old, new, target):
    text = source.read_text()
    if text.count(old) != 1:
        raise SystemExit(f"{source.name} has {text.count(old)} times: {old}")
    target.write_text(text.replace(old, new))
    return target


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--leeway", required=True)
    options.add_argument("--compiler", default="cc")
    options.add_argument("--mutations", type=int, default=3000)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--name", action="append", default=[], help="only mistakes whose name has this part; repeatable")
    given = options.parse_args()
    missed, count = 0, 0
    with tempfile.TemporaryDirectory() as root:
        folder = pathlib.Path(root)
        compiled = lambda source: subprocess.run([given.compiler, "-O1", "-w", "-o", folder / "check", source, "-lm"], check=True)  # noqa: E731
        planned = [(True, "0", one) for one in IN_C] + [(True, "1", one) for one in IN_C_ALONE] + [(False, "1", one) for one in IN_PYTHON]
        for in_c, share, (name, old, new) in planned:
            if given.name and not any(part in name for part in given.name):
                continue
            begin, count = time.monotonic(), count + 1
            python = CERTIFY / "check_certificate.py"
            if in_c:
                compiled(planted(CERTIFY / "check_certificate.c", old, new, folder / "planted.c"))
            else:
                compiled(CERTIFY / "check_certificate.c")
                python = planted(python, old, new, folder / "planted.py")
            run = subprocess.run([sys.executable, HERE / "certificates.py", "--leeway", given.leeway, "--checker", folder / "check", "--python-checker", python,
                "--worlds", "3", "--mutations", str(given.mutations), "--seed", str(given.seed), "--until-wrong", "--python-share", share],
                capture_output=True, text=True, check=False)
            lines = run.stdout.strip().splitlines()
            found = run.returncode == 1 and len(lines) > 1
            missed += not found
            print(f"{'found ' if found else 'MISSED'} {'C' if in_c else 'Python'}: {name}, {time.monotonic() - begin:.0f} s:",
                lines[-1].strip()[:150] if lines else run.stderr.strip()[-300:], flush=True)
    print(f"{count} mistakes planted, {missed} not found")
    return int(missed > 0 or count == 0)


if __name__ == "__main__":
    sys.exit(main())
