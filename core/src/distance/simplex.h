// SPDX-License-Identifier: BSD-3-Clause
// The point of a simplex nearest to the origin, in double.
#ifndef LEEWAY_DISTANCE_SIMPLEX_H
#define LEEWAY_DISTANCE_SIMPLEX_H

#include <math.h>
#include <stdbool.h>

#define real double
#define NAME( x ) x##_d
#define FROM( x ) ( x )
#define ADD( a, b ) ( ( a ) + ( b ) )
#define SUB( a, b ) ( ( a ) - ( b ) )
#define MUL( a, b ) ( ( a ) * ( b ) )
#define DIV( a, b ) ( ( a ) / ( b ) )
#define SIGN( a ) ( a )
#include "distance/convex_simplex_impl.h"

#endif
