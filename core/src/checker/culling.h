// SPDX-License-Identifier: BSD-3-Clause
// The obstacles that a group can come near to. Derivation: core/docs/required.md.
#ifndef LEEWAY_CHECKER_CULLING_H
#define LEEWAY_CHECKER_CULLING_H

#include "checker/checker.h"
#include "checker/clusters.h"

enum
{
	LWI_COVER_BALLS = 16 ///< of a cover between two joints
};

typedef struct lwi_cover_ball
{
	double c[3], r;
} lwi_cover_ball;

/// All that the bodies of a node sweep, in the world: within the balls, and also within the one ball `chain`.
typedef struct lwi_cover
{
	lwi_cover_ball balls[LWI_COVER_BALLS];
	lwi_cover_ball chain;
	uint32_t count; ///< of balls; 0: the node has no bodies
	bool unbounded; ///< they may be anywhere
} lwi_cover;

/// For a checker with its tree. Depends on no scene.
void lwi_cover_node( const lw_checker* checker, const lwi_checker_node* node, const bool* joint_moves, lwi_cover* out );

/// Metres: proved distance between the cover and every static shape; 0 if nothing is proved.
double lwi_cover_distance( const lw_shape* shape, const lw_transform* world_from_shape, const lwi_cover* cover );

/// Results of an earlier checker of a similar scene.
typedef struct lwi_kept
{
	const lw_checker* previous; ///< NULL = none
	uint32_t* source; ///< [shape_count] the same shape at the same pose in the previous scene, or LW_INVALID_INDEX
} lwi_kept;

/// Fills near_mask and the fields about it. For a checker with its base, its masks and its static environment.
void lwi_checker_require( lw_checker* checker, const lwi_kept* kept );

/// Values of a variable for which near_mask holds: its limits, widened; infinite for angles that go round and quaternions.
void lwi_required_range( const lw_robot* robot, uint32_t variable, double* out_lower, double* out_upper );

#endif
