// SPDX-License-Identifier: BSD-3-Clause
// The obstacles that a group can come near to. Derivation: core/docs/required.md.
#ifndef LEEWAY_CHECKER_CULLING_H
#define LEEWAY_CHECKER_CULLING_H

#include "checker/checker.h"
#include "checker/clusters.h"

LW_EXTERN_C_BEGIN

enum
{
	LWI_ENVELOPE_SPHERES = 16 ///< of an envelope between two joints
};

typedef struct lwi_envelope_sphere
{
	double c[3], r;
} lwi_envelope_sphere;

/// All that the bodies of a cluster sweep, in the world: within the balls, and also within the one ball `chain`.
typedef struct lwi_envelope
{
	lwi_envelope_sphere balls[LWI_ENVELOPE_SPHERES];
	lwi_envelope_sphere chain;
	uint32_t count; ///< of balls; 0: the cluster has no bodies
	bool unbounded; ///< they may be anywhere
} lwi_envelope;

/// For a checker with its tree. Depends on no scene.
void lwi_envelope_of_cluster( const lw_checker* checker, const lwi_cluster* cluster, const bool* joint_moves, lwi_envelope* out );

/// Metres: proved distance between the envelope and every static shape; 0 if nothing is proved.
double lwi_envelope_distance( const lw_shape* shape, const lw_transform* world_from_shape, const lwi_envelope* envelope );

/// Results of an earlier checker of a similar scene.
typedef struct lwi_reuse
{
	const lw_checker* previous; ///< NULL = none
	uint32_t* source; ///< [shape_count] the same shape at the same pose in the previous scene, or LW_INVALID_INDEX
} lwi_reuse;

/// Fills near_mask and the fields about it. For a checker with its base, its masks and its static environment.
void lwi_checker_cull( lw_checker* checker, const lwi_reuse* reuse );

/// Values of a variable for which near_mask holds: its limits, widened; infinite for angles that go round and quaternions.
void lwi_cull_range( const lw_robot* robot, uint32_t variable, double* out_lower, double* out_upper );

LW_EXTERN_C_END

#endif
