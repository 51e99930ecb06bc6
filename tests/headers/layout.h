// SPDX-License-Identifier: BSD-3-Clause
// Structs with atomic fields, for layout.c and layout_test.cpp: X( type, field behind the atomic one ).
#ifndef LEEWAY_TESTS_LAYOUT_H
#define LEEWAY_TESTS_LAYOUT_H

#include "checker/checker.h"
#include "reachability/proof.h"
#include "robot/robot.h"
#include "scene/scene.h"
#include "shape/shape.h"

#include <stddef.h>

#define LAYOUTS( X )                                                                                                        \
	X( struct lw_shape, allocator )                                                                                         \
	X( struct lw_robot, allocator )                                                                                         \
	X( struct lw_scene, allocator )                                                                                         \
	X( struct lw_checker, allocator )                                                                                       \
	X( struct lw_reach, allocator )                                                                                         \
	X( lwi_deferred, made )                                                                                                 \
	X( lwi_reach_stage, last_report )                                                                                       \
	X( lwi_pair_analysers, out_of_memory )

#define LAYOUT_OF( type, field ) { #type, sizeof( type ), offsetof( type, field ) },

typedef struct layout
{
	const char* type;
	size_t size, offset;
} layout;

LW_EXTERN_C_BEGIN

/// The layouts as C sees them. @param count written
const layout* layouts_of_c( size_t* count );

LW_EXTERN_C_END

#endif
