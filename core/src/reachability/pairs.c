// SPDX-License-Identifier: BSD-3-Clause
// Classifies each pair of links: contact found, proved apart, or to be checked. Samples first, since pairs in contact
// need no proof; then proofs by hulls; a search for contact; and grids and proofs by subdivision (reachability/effort.c).
//
// Classes as MoveIt's Setup Assistant names them (adjacent, never, always, default), but "never" is proved here, not
// sampled.
#include "base/math_inline.h"
#include "reachability/effort.h"

#include <string.h>

/// Metres. Pairs found in contact before are only tested for contact again.
#define CONTACT_LIMIT 1e-6

/// A random state is nearer if its distance is less than this share of the least one. Where a joint keeps a gap all around,
/// hundreds of pairs of triangles are that far apart in every state, and to order them took xArm7's samples 20 times as long.
#define NEARER 0.9

enum
{
	SEARCH_PER_VARIABLE = 100, ///< measurements of a search for contact, per variable of the pair and one more
	SAMPLE_TASKS = 16,         ///< random states are measured in so many parts, on any number of threads
	LEAST_SAMPLES = 4,         ///< of a part
	LINKS_AT_ONCE = 16         ///< whose hulls are swept between two looks at the clock
};

/// Shares of the time after which the next thing begins, if there is a limit.
#define SAMPLES_UNTIL 0.2
#define HULLS_UNTIL 0.5
#define SEARCH_UNTIL 0.6

typedef struct work
{
	const lwi_reach_job* job; ///< without a diag: threads must not write to it
	lw_reach* reach;
	const lw_robot* robot;
	lwi_pair_analysers analysers;
	lwi_pair_list list;
	double begin, seconds;     ///< INFINITY: no limit
	uint32_t* geometry_parent; ///< [link_count] nearest link above that has geometry, or LW_INVALID_INDEX
	bool* has_geometry;        ///< [link_count]
} work;

/// @param share of the time after which it is too late
static double until( const work* w, double share )
{
	return w->begin + share * w->seconds;
}

static bool is_cancelled( const work* w )
{
	return w->job->stage != NULL && atomic_load( &w->job->stage->cancelled );
}

static size_t state_bytes( const work* w )
{
	return w->robot->variable_count * sizeof( double );
}

// ---- which pairs there are -------------------------------------------------------------------------------------------

static void find_geometry( work* w )
{
	const lw_robot* robot = w->robot;
	for ( uint32_t i = 0; i < robot->body_count; ++i )
	{
		w->has_geometry[robot->bodies[i].link] = true;
	}
	for ( uint32_t k = 0; k < robot->link_count; ++k )
	{
		uint32_t link = robot->link_order[k], joint = robot->link_joint[link];
		uint32_t parent = joint != LW_INVALID_INDEX ? robot->joints[joint].parent : LW_INVALID_INDEX;
		bool skip = parent != LW_INVALID_INDEX && !w->has_geometry[parent];
		w->geometry_parent[link] = skip ? w->geometry_parent[parent] : parent;
	}
}

static bool is_listed( const lw_robot* robot, uint32_t a, uint32_t b )
{
	size_t bit = (size_t)a * robot->link_count + b;
	return ( ( robot->allowed[bit / 32] >> ( bit % 32 ) ) & 1u ) != 0;
}

/// Fills the fields that do not depend on distances, for all pairs. Returns the number of those that may move, which get a
/// state.
static uint32_t classify_by_links( work* w )
{
	uint32_t count = 0;
	for ( uint32_t a = 1; a < w->reach->link_count; ++a )
	{
		for ( uint32_t b = 0; b < a; ++b )
		{
			size_t index = lwi_reach_pair_index( a, b );
			lw_reach_pair* pair = &w->reach->pairs[index];
			bool geometry = w->has_geometry[a] && w->has_geometry[b];
			pair->adjacent = geometry && ( w->geometry_parent[a] == b || w->geometry_parent[b] == a );
			pair->allowed = is_listed( w->robot, a, b );
			bool moves = geometry && w->robot->rigid_group[a] != w->robot->rigid_group[b];
			pair->kind = !geometry ? LW_PAIR_NONE : moves ? LW_PAIR_CHECK : LW_PAIR_RIGID;
			w->reach->states[index] = moves ? count++ : LW_INVALID_INDEX;
		}
	}
	return count;
}

static lw_status list_pairs( work* w )
{
	lw_reach* reach = w->reach;
	uint32_t count = classify_by_links( w );
	reach->evidence = lwi_alloc_zero( &reach->allocator, (size_t)count * reach->variable_count, sizeof( double ) );
	reach->efforts = lwi_alloc_zero( &reach->allocator, count, sizeof( lwi_effort ) );
	reach->evidence_count = reach->evidence != NULL && reach->efforts != NULL ? count : 0;
	lwi_pair_analyser* analyser =
		reach->evidence != NULL && reach->efforts != NULL ? lwi_pair_analysers_take( &w->analysers ) : NULL;
	if ( analyser == NULL )
	{
		lwi_free( &reach->allocator, reach->evidence, (size_t)count * reach->variable_count * sizeof( double ) );
		lwi_free( &reach->allocator, reach->efforts, count * sizeof( lwi_effort ) );
		reach->evidence = NULL;
		reach->efforts = NULL;
		reach->evidence_count = 0;
		return LW_ERROR_OUT_OF_MEMORY;
	}
	for ( uint32_t a = 1; a < reach->link_count; ++a )
	{
		for ( uint32_t b = 0; b < a; ++b )
		{
			size_t index = lwi_reach_pair_index( a, b );
			if ( reach->states[index] != LW_INVALID_INDEX )
			{
				lwi_pair_analyser_select( analyser, a, b );
				reach->pairs[index].variable_count = analyser->variable_count;
				reach->efforts[reach->states[index]].flags = analyser->bounded ? (uint32_t)LWI_EFFORT_BOUNDED : 0u;
			}
		}
	}
	lwi_pair_analysers_give( &w->analysers, analyser );
	return LW_OK;
}

/// Finds the entries of all pairs that move.
static lw_status fill_list( work* w )
{
	lw_reach* reach = w->reach;
	w->list.seed = reach->seed;
	w->list.active = lwi_alloc_zero( &reach->allocator, reach->evidence_count, sizeof( lwi_active ) );
	if ( w->list.active == NULL )
	{
		return LW_ERROR_OUT_OF_MEMORY;
	}
	w->list.count = reach->evidence_count;
	for ( uint32_t a = 1; a < reach->link_count; ++a )
	{
		for ( uint32_t b = 0; b < a; ++b )
		{
			size_t index = lwi_reach_pair_index( a, b );
			uint32_t i = reach->states[index];
			if ( i != LW_INVALID_INDEX )
			{
				w->list.active[i] = ( lwi_active ){ a, b, &reach->pairs[index], &reach->efforts[i],
					reach->evidence + (size_t)i * reach->variable_count };
			}
		}
	}
	return LW_OK;
}

// ---- samples ---------------------------------------------------------------------------------------------------------

/// The closest distance of a pair in a part of the random states.
typedef struct sighting
{
	double closest;
	uint32_t sample; ///< where; LW_INVALID_INDEX: not nearer than before
	uint32_t contacts, visits;
} sighting;

/// Parts of a batch of random states: each has a row of sightings.
typedef struct batch
{
	work* w;
	uint32_t first, count, parts;
	double deadline;
	sighting* seen; ///< [parts][list.count]
	atomic_uint measured;
} batch;

/// Each random state has its own stream, so that its values do not depend on the thread.
static void sample_state( const work* w, const lwi_pair_analyser* analyser, uint32_t sample, double* q )
{
	uint64_t random = w->reach->seed ^ ( ( sample + 1u ) * 0xd1342543de82ef95u );
	lwi_pair_analyser_random_state( analyser, &random, NULL, w->robot->variable_count, q );
}

/// True if bounding spheres of two links meet.
static bool spheres_meet( const lwi_pair_analyser* p, const lw_transform* poses, uint32_t link_a, uint32_t link_b )
{
	for ( uint32_t i = p->first_body[link_a]; i < p->first_body[link_a + 1]; ++i )
	{
		uint32_t a = p->body_order[i];
		lw_vec3 center = lwi_transform( &poses[link_a], lwi_load( p->centers + 3 * (size_t)a ) );
		for ( uint32_t j = p->first_body[link_b]; j < p->first_body[link_b + 1]; ++j )
		{
			uint32_t b = p->body_order[j];
			double radii = lwi_shape_now( p->robot->bodies[a].shape )->sphere_radius +
						   lwi_shape_now( p->robot->bodies[b].shape )->sphere_radius;
			lw_vec3 from_b_to_a = lwi_sub( center, lwi_transform( &poses[link_b], lwi_load( p->centers + 3 * (size_t)b ) ) );
			if ( lwi_length_sq( from_b_to_a ) < radii * radii )
			{
				return true;
			}
		}
	}
	return false;
}

/// Measures all pairs at analyser->state as far as they are nearer than before, or in contact again.
static void measure_state( const work* w, lwi_pair_analyser* analyser, lw_transform* poses, uint32_t sample, sighting* seen )
{
	if ( lw_robot_fk( w->robot, analyser->state, poses ) != LW_OK )
	{
		return;
	}
	for ( uint32_t i = 0; i < w->list.count; ++i )
	{
		const lwi_active* active = &w->list.active[i];
		lw_range range = { 0, fmax( NEARER * seen[i].closest, CONTACT_LIMIT ), 0 };
		lwi_bound bound;
		lwi_pair_analyser_measure_links( analyser, poses, active->link_a, active->link_b, &range, NULL, &bound );
		if ( bound.upper < seen[i].closest )
		{
			seen[i].closest = bound.upper;
			seen[i].sample = sample;
		}
		seen[i].contacts += bound.upper <= 0 ? 1u : 0u;
		seen[i].visits += bound.upper <= 0 || spheres_meet( analyser, poses, active->link_a, active->link_b ) ? 1u : 0u;
	}
}

static void measure_part( void* context, uint32_t part )
{
	batch* b = context;
	const work* w = b->w;
	sighting* seen = b->seen + (size_t)part * w->list.count;
	lwi_pair_analyser* analyser = lwi_pair_analysers_take( &b->w->analysers );
	lw_transform* poses = lwi_alloc_zero( &w->reach->allocator, w->reach->link_count, sizeof( lw_transform ) );
	if ( poses == NULL )
	{
		atomic_store( &b->w->analysers.out_of_memory, true );
	}
	for ( uint32_t k = part; k < b->count && analyser != NULL && poses != NULL; k += b->parts )
	{
		if ( !lwi_reach_goes_on( w->job ) )
		{
			break;
		}
		sample_state( w, analyser, b->first + k, analyser->state );
		measure_state( w, analyser, poses, b->first + k, seen );
		lwi_reach_step( w->job );
	}
	lwi_free( &w->reach->allocator, poses, w->reach->link_count * sizeof( lw_transform ) );
	lwi_pair_analysers_give( &b->w->analysers, analyser );
}

/// Enters the sightings, part by part: the result does not depend on threads.
static void enter_sightings( const batch* b, lwi_pair_analyser* analyser )
{
	const work* w = b->w;
	for ( uint32_t part = 0; part < b->parts; ++part )
	{
		for ( uint32_t i = 0; i < w->list.count; ++i )
		{
			const sighting* seen = &b->seen[(size_t)part * w->list.count + i];
			const lwi_active* active = &w->list.active[i];
			active->effort->contacts += seen->contacts;
			active->effort->visits += seen->visits;
			if ( seen->sample != LW_INVALID_INDEX && seen->closest < active->pair->closest )
			{
				active->pair->closest = seen->closest;
				sample_state( w, analyser, seen->sample, active->state );
			}
		}
	}
}

static void measure_default( work* w, lwi_pair_analyser* analyser, lw_transform* poses, sighting* seen )
{
	for ( uint32_t i = 0; i < w->list.count; ++i )
	{
		seen[i] = ( sighting ){ .closest = INFINITY, .sample = LW_INVALID_INDEX };
	}
	lw_robot_default_state( w->robot, analyser->state );
	measure_state( w, analyser, poses, 0, seen );
	for ( uint32_t i = 0; i < w->list.count; ++i )
	{
		const lwi_active* active = &w->list.active[i];
		active->effort->flags |= seen[i].contacts > 0 ? (uint32_t)LWI_EFFORT_DEFAULT : 0u;
		// an earlier run that had no time for samples may have searched nearer
		if ( seen[i].sample != LW_INVALID_INDEX && seen[i].closest < active->pair->closest )
		{
			active->pair->closest = seen[i].closest;
			memcpy( active->state, analyser->state, state_bytes( w ) );
		}
	}
}

/// Random states from the last one on, in batches that double: each batch knows the results of those before it.
static lw_status measure_batches( work* w, batch* b, lwi_pair_analyser* analyser, uint32_t samples )
{
	lw_reach* reach = w->reach;
	double deadline = until( w, SAMPLES_UNTIL );
	while ( reach->sample_count < samples && lwi_monotonic_seconds() < deadline && !is_cancelled( w ) )
	{
		uint32_t left = samples - reach->sample_count, least = SAMPLE_TASKS * LEAST_SAMPLES;
		// not more than doubles, and where time is short not more than a batch between two looks at the clock
		uint32_t most = reach->sample_count < least || w->seconds < INFINITY ? least : reach->sample_count;
		b->first = reach->sample_count;
		b->count = left < most ? left : most;
		b->parts = SAMPLE_TASKS;
		for ( uint32_t k = 0; k < b->parts * w->list.count; ++k )
		{
			b->seen[k] = ( sighting ){ w->list.active[k % w->list.count].pair->closest, LW_INVALID_INDEX, 0, 0 };
		}
		lwi_reach_run( w->job, measure_part, b, b->parts );
		if ( atomic_load( &w->analysers.out_of_memory ) )
		{
			return LW_ERROR_OUT_OF_MEMORY;
		}
		enter_sightings( b, analyser );
		reach->sample_count += b->count;
	}
	return LW_OK;
}

static lw_status take_samples( work* w )
{
	lw_reach* reach = w->reach;
	uint32_t samples = w->job->def->samples;
	bool fresh = reach->sample_count == 0;
	if ( w->list.count == 0 || ( !fresh && reach->sample_count >= samples ) )
	{
		return LW_OK;
	}
	lwi_reach_begin( w->job, "samples", 0, samples - reach->sample_count );
	size_t rows = (size_t)SAMPLE_TASKS * w->list.count;
	batch b = { .w = w, .seen = lwi_alloc( &reach->allocator, rows * sizeof( sighting ) ) };
	lw_transform* poses = lwi_alloc_zero( &reach->allocator, reach->link_count, sizeof( lw_transform ) );
	lwi_pair_analyser* analyser = lwi_pair_analysers_take( &w->analysers );
	lw_status status = LW_ERROR_OUT_OF_MEMORY;
	if ( b.seen != NULL && poses != NULL && analyser != NULL )
	{
		if ( fresh )
		{
			measure_default( w, analyser, poses, b.seen );
		}
		status = measure_batches( w, &b, analyser, samples );
	}
	lwi_pair_analysers_give( &w->analysers, analyser );
	lwi_free( &reach->allocator, poses, reach->link_count * sizeof( lw_transform ) );
	lwi_free( &reach->allocator, b.seen, rows * sizeof( sighting ) );
	return status;
}

// ---- proofs by hulls -------------------------------------------------------------------------------------------------

/// Hulls of some links, and the pairs whose hulls are all made.
typedef struct sweep
{
	work* w;
	lwi_sweeps* sweeps;
	uint32_t* level; ///< [link_count] up to which the link's hulls are wanted
	uint32_t* links; ///< [link_count] that are swept now
	uint32_t link_count;
	uint32_t* pairs; ///< [list.count] that are compared then
	uint32_t pair_count;
	bool* listed; ///< [link_count]
	atomic_bool failed;
} sweep;

static void sweep_link( void* context, uint32_t index )
{
	sweep* s = context;
	uint32_t link = s->links[index];
	if ( lwi_reach_goes_on( s->w->job ) && lwi_sweeps_make( s->sweeps, link, s->level[link] ) != LW_OK )
	{
		atomic_store( &s->failed, true );
	}
}

static void compare_hulls( void* context, uint32_t index )
{
	sweep* s = context;
	const lwi_active* active = &s->w->list.active[s->pairs[index]];
	double separation = 0;
	if ( !lwi_reach_goes_on( s->w->job ) )
	{
		return;
	}
	if ( lwi_sweeps_separation( s->sweeps, active->link_a, active->link_b, &separation ) != LW_OK )
	{
		atomic_store( &s->failed, true );
		return;
	}
	if ( separation > active->pair->separation )
	{
		active->pair->separation = separation;
		active->pair->proof = LW_PROOF_HULL;
	}
	active->effort->flags |= (uint32_t)LWI_EFFORT_HULLS;
	lwi_reach_step( s->w->job );
}

static bool wants_hulls( const lwi_active* active )
{
	return active->pair->closest > 0 && ( active->effort->flags & LWI_EFFORT_HULLS ) == 0;
}

static void list_link( sweep* s, uint32_t link, uint32_t other )
{
	uint32_t level = lwi_sweeps_level( s->sweeps, link, other );
	s->level[link] = level > s->level[link] ? level : s->level[link];
	if ( !s->listed[link] )
	{
		s->listed[link] = true;
		s->links[s->link_count++] = link;
	}
}

/// The next pairs, of few links. False if there are none.
static bool list_sweep( sweep* s )
{
	s->link_count = s->pair_count = 0;
	memset( s->listed, 0, s->w->reach->link_count * sizeof( bool ) );
	for ( uint32_t i = 0; i < s->w->list.count; ++i )
	{
		const lwi_active* active = &s->w->list.active[i];
		if ( !wants_hulls( active ) )
		{
			continue;
		}
		uint32_t more = ( s->listed[active->link_a] ? 0u : 1u ) + ( s->listed[active->link_b] ? 0u : 1u );
		if ( s->link_count + more <= LINKS_AT_ONCE )
		{
			list_link( s, active->link_a, active->link_b );
			list_link( s, active->link_b, active->link_a );
			s->pairs[s->pair_count++] = i;
		}
	}
	return s->pair_count > 0;
}

static lw_status run_sweeps( sweep* s, double deadline )
{
	lw_status status = LW_OK;
	while ( status == LW_OK && lwi_monotonic_seconds() < deadline && !is_cancelled( s->w ) && list_sweep( s ) )
	{
		lwi_reach_run( s->w->job, sweep_link, s, s->link_count );
		if ( !atomic_load( &s->failed ) && !is_cancelled( s->w ) )
		{
			lwi_reach_run( s->w->job, compare_hulls, s, s->pair_count );
		}
		status = atomic_load( &s->failed ) ? LW_ERROR_OUT_OF_MEMORY : status;
	}
	return status;
}

static lw_status prove_by_hulls( work* w )
{
	const lw_allocator* memory = &w->reach->allocator;
	uint32_t links = w->reach->link_count, wanted = 0;
	for ( uint32_t i = 0; i < w->list.count; ++i )
	{
		wanted += wants_hulls( &w->list.active[i] ) ? 1u : 0u;
	}
	if ( wanted == 0 )
	{
		return LW_OK;
	}
	lwi_reach_begin( w->job, "hulls of pairs", 0, wanted );
	sweep s = { .w = w };
	atomic_init( &s.failed, false );
	s.level = lwi_alloc_zero( memory, links, sizeof( uint32_t ) );
	s.links = lwi_alloc_zero( memory, links, sizeof( uint32_t ) );
	s.listed = lwi_alloc_zero( memory, links, sizeof( bool ) );
	s.pairs = lwi_alloc_zero( memory, w->list.count, sizeof( uint32_t ) );
	bool ready = s.level != NULL && s.links != NULL && s.listed != NULL && s.pairs != NULL;
	lw_status status = ready ? lwi_sweeps_create( w->job, &s.sweeps ) : LW_ERROR_OUT_OF_MEMORY;
	status = status == LW_OK ? run_sweeps( &s, until( w, HULLS_UNTIL ) ) : status;
	lwi_sweeps_destroy( s.sweeps );
	lwi_free( memory, s.pairs, w->list.count * sizeof( uint32_t ) );
	lwi_free( memory, s.listed, links * sizeof( bool ) );
	lwi_free( memory, s.links, links * sizeof( uint32_t ) );
	lwi_free( memory, s.level, links * sizeof( uint32_t ) );
	return status;
}

// ---- search for contact ----------------------------------------------------------------------------------------------

static bool wants_search( const lwi_active* active )
{
	const uint32_t both = LWI_EFFORT_SEARCH | LWI_EFFORT_HULLS;
	return active->pair->closest > 0 && active->pair->separation <= 0 &&
		   ( active->effort->flags & both ) == LWI_EFFORT_HULLS;
}

static void search_pair( void* context, uint32_t index )
{
	work* w = context;
	const lwi_active* active = &w->list.active[index];
	bool late = lwi_monotonic_seconds() >= until( w, SEARCH_UNTIL ) || !lwi_reach_goes_on( w->job );
	lwi_pair_analyser* analyser = !late && wants_search( active ) ? lwi_pair_analysers_take( &w->analysers ) : NULL;
	if ( analyser != NULL )
	{
		lwi_pair_analyser_select( analyser, active->link_a, active->link_b );
		lwi_pair_analyser_search( analyser, lwi_pair_seed( &w->list, active ),
			SEARCH_PER_VARIABLE * ( active->pair->variable_count + 1 ), &active->pair->closest, active->state );
		active->effort->flags |= (uint32_t)LWI_EFFORT_SEARCH;
		lwi_pair_analysers_give( &w->analysers, analyser );
	}
	lwi_reach_step( w->job );
}

static lw_status search_contacts( work* w )
{
	lwi_reach_begin( w->job, "search for contact", 0, w->list.count );
	lwi_reach_run( w->job, search_pair, w, w->list.count );
	return atomic_load( &w->analysers.out_of_memory ) ? LW_ERROR_OUT_OF_MEMORY : LW_OK;
}

// ---- classes ---------------------------------------------------------------------------------------------------------

/// Distance of two links at analyser->trial as anyone would measure it: lw_robot_fk() and lw_shape_distance().
static double plain_distance( const lwi_pair_analyser* p, const lw_transform* poses, uint32_t link_a, uint32_t link_b )
{
	double least = INFINITY;
	for ( uint32_t i = p->first_body[link_a]; i < p->first_body[link_a + 1]; ++i )
	{
		for ( uint32_t j = p->first_body[link_b]; j < p->first_body[link_b + 1]; ++j )
		{
			const lw_body_def* a = &p->robot->bodies[p->body_order[i]];
			const lw_body_def* b = &p->robot->bodies[p->body_order[j]];
			lw_transform pose_a = lwi_multiply( &poses[link_a], &a->link_from_shape );
			lw_transform pose_b = lwi_multiply( &poses[link_b], &b->link_from_shape );
			lw_clearance clearance;
			lw_shape_distance( a->shape, &pose_a, b->shape, &pose_b, NULL, p->query, &clearance );
			least = fmin( least, clearance.upper );
		}
	}
	return least;
}

/// The evidence moves nothing but the pair's own variables away from the default state, and its distance equals a user's
/// measurement there. (Searches measure seen from the common ancestor: the same up to rounding.)
static void finish_evidence( const lwi_active* active, lwi_pair_analyser* p, lw_transform* poses )
{
	lwi_pair_analyser_select( p, active->link_a, active->link_b );
	lw_robot_default_state( p->robot, p->trial );
	for ( uint32_t i = 0; i < p->variable_count; ++i )
	{
		p->trial[p->variables[i]] = active->state[p->variables[i]];
	}
	memcpy( active->state, p->trial, p->robot->variable_count * sizeof( double ) );
	bool posed = lw_robot_fk( p->robot, p->trial, poses ) == LW_OK;
	active->pair->closest = posed ? plain_distance( p, poses, active->link_a, active->link_b ) : INFINITY;
}

static void classify( const work* w, const lwi_active* active )
{
	lw_reach_pair* pair = active->pair;
	uint32_t samples = w->reach->sample_count;
	pair->contact_share = samples > 0 ? (double)active->effort->contacts / samples : 0;
	// Proofs are about real numbers, measurements round: a separation never promises more than was measured
	pair->separation = fmin( pair->separation, pair->closest );
	pair->proof = pair->separation > 0 ? pair->proof : LW_PROOF_NONE;
	bool at_default = ( active->effort->flags & LWI_EFFORT_DEFAULT ) != 0;
	bool always = samples > 0 && active->effort->contacts == samples && at_default && pair->closest <= 0;
	pair->kind = pair->adjacent         ? LW_PAIR_ADJACENT
				 : pair->allowed        ? LW_PAIR_ALLOWED
				 : pair->separation > 0 ? LW_PAIR_NEVER
				 : always               ? LW_PAIR_ALWAYS
										: LW_PAIR_CHECK;
}

static void finish_pair( void* context, uint32_t index )
{
	work* w = context;
	const lwi_active* active = &w->list.active[index];
	lw_transform* poses = lwi_alloc_zero( &w->reach->allocator, w->reach->link_count, sizeof( lw_transform ) );
	lwi_pair_analyser* analyser = poses != NULL ? lwi_pair_analysers_take( &w->analysers ) : NULL;
	if ( analyser != NULL )
	{
		finish_evidence( active, analyser, poses );
		classify( w, active );
	}
	else
	{
		atomic_store( &w->analysers.out_of_memory, true );
	}
	lwi_pair_analysers_give( &w->analysers, analyser );
	lwi_free( &w->reach->allocator, poses, w->reach->link_count * sizeof( lw_transform ) );
}

// ---- all of it -------------------------------------------------------------------------------------------------------

static lw_status report( const lwi_reach_job* job, const work* w, lw_status status )
{
	if ( status == LW_OK && is_cancelled( w ) )
	{
		return lwi_fail( job->diag, LW_ERROR_CANCELLED, LW_INVALID_INDEX, "given up by the progress callback" );
	}
	return status == LW_ERROR_OUT_OF_MEMORY ? lwi_out_of_memory( job->diag, "pairs of links" ) : status;
}

lw_status lwi_reach_list_pairs( const lwi_reach_job* job )
{
	lwi_reach_job quiet = { job->def, job->reach, NULL, job->stage };
	work w = { .job = &quiet, .reach = job->reach, .robot = job->reach->robot };
	w.analysers.job = &quiet;
	const lw_allocator* memory = &w.reach->allocator;
	size_t links = w.reach->link_count;
	w.geometry_parent = lwi_alloc_zero( memory, links, sizeof( uint32_t ) );
	w.has_geometry = lwi_alloc_zero( memory, links, sizeof( bool ) );
	lw_status status = LW_ERROR_OUT_OF_MEMORY;
	if ( w.geometry_parent != NULL && w.has_geometry != NULL )
	{
		find_geometry( &w );
		status = list_pairs( &w );
	}
	lwi_pair_analysers_free( &w.analysers );
	lwi_free( memory, w.geometry_parent, links * sizeof( uint32_t ) );
	lwi_free( memory, w.has_geometry, links * sizeof( bool ) );
	return report( job, &w, status );
}

static lw_status measure_and_prove( work* w )
{
	w->begin = lwi_monotonic_seconds();
	w->seconds = w->job->def->seconds > 0 ? w->job->def->seconds : INFINITY;
	lw_status status = take_samples( w );
	status = status == LW_OK && !is_cancelled( w ) ? prove_by_hulls( w ) : status;
	status = status == LW_OK && !is_cancelled( w ) ? search_contacts( w ) : status;
	if ( w->seconds < INFINITY && status == LW_OK && !is_cancelled( w ) )
	{
		lwi_reach_begin( w->job, "grids and proofs", w->begin + w->seconds - lwi_monotonic_seconds(), 0 );
		status = lwi_reach_spend( &w->analysers, &w->list, w->begin + w->seconds );
	}
	if ( status == LW_OK && !is_cancelled( w ) )
	{
		lwi_reach_run( w->job, finish_pair, w, w->list.count );
		w->reach->seconds += lwi_monotonic_seconds() - w->begin;
	}
	return atomic_load( &w->analysers.out_of_memory ) ? LW_ERROR_OUT_OF_MEMORY : status;
}

lw_status lwi_reach_build_pairs( const lwi_reach_job* job )
{
	lwi_reach_job quiet = { job->def, job->reach, NULL, job->stage };
	work w = { .job = &quiet, .reach = job->reach, .robot = job->reach->robot };
	w.analysers.job = &quiet;
	lw_status status = fill_list( &w );
	if ( status == LW_OK && job->def->hulls_only )
	{
		for ( uint32_t i = 0; i < w.list.count; ++i )
		{
			classify( &w, &w.list.active[i] );
		}
	}
	else if ( status == LW_OK )
	{
		status = measure_and_prove( &w );
	}
	lwi_pair_analysers_free( &w.analysers );
	lwi_free( &w.reach->allocator, w.list.active, w.reach->evidence_count * sizeof( lwi_active ) );
	return report( job, &w, status );
}
