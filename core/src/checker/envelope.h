// SPDX-License-Identifier: BSD-3-Clause
// Swept volumes of clusters, enclosed by a few spheres. Derivation: core/docs/required.md.
#ifndef LEEWAY_CHECKER_ENVELOPE_H
#define LEEWAY_CHECKER_ENVELOPE_H

#include "checker/clusters.h"
#include "leeway/reach.h"
#include "shape/shape.h"

LW_EXTERN_C_BEGIN

struct lwi_checker_base;

enum
{
	LWI_ENVELOPE_SPHERES = 16 ///< of an envelope between two joints
};

/// All that the bodies of a cluster sweep, in the world: within the spheres, and also within `bounding`.
typedef struct lwi_envelope
{
	lw_sphere spheres[LWI_ENVELOPE_SPHERES];
	lw_sphere bounding;
	uint32_t count; ///< of spheres; 0: the cluster has no bodies
	bool unbounded; ///< they may be anywhere
} lwi_envelope;

/// For a base with its tree.
void lwi_envelope_of_cluster( const struct lwi_checker_base* base, const lwi_cluster* cluster, const bool* joint_moves,
	lwi_envelope* out );

/// Metres: proved distance between the envelope and every static shape; 0 if nothing is proved.
double lwi_envelope_distance( const lw_shape* shape, const lw_transform* world_from_shape, const lwi_envelope* envelope );

/// Values of a variable that envelopes allow for: its limits, widened; infinite for angles that go round and quaternions.
void lwi_envelope_range( const lw_robot* robot, uint32_t variable, double* out_lower, double* out_upper );

LW_EXTERN_C_END

#endif
