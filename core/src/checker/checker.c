// SPDX-License-Identifier: BSD-3-Clause
// The answer for one state: environment, self, and the verdict of both.
#include "checker/checker.h"
#include "scene/scene.h"

const char* lw_verdict_name( lw_verdict verdict )
{
	switch ( verdict )
	{
	case LW_VERDICT_FREE:
		return "FREE";
	case LW_VERDICT_BLOCKED:
		return "BLOCKED";
	case LW_VERDICT_UNDECIDED:
		return "UNDECIDED";
	case LW_VERDICT_UNKNOWN:
		break;
	}
	return "UNKNOWN";
}

static bool is_proved_free( const lw_clearance* clearance, double min_d )
{
	return ( clearance->kind == LW_CLEARANCE_NEAR || clearance->kind == LW_CLEARANCE_FAR ) && clearance->lower > min_d;
}

lwi_query_sizes lwi_checker_query_sizes( const lw_checker* checker, uint32_t spare_shapes, uint32_t spare_bodies )
{
	const uint32_t scene_shapes = checker->scene != NULL ? checker->scene->shape_count : 0;
	lwi_query_sizes sizes = { .links = lw_robot_link_count( checker->base->robot ) + spare_bodies,
		.bodies = lw_robot_body_count( checker->base->robot ) + spare_bodies,
		.variables = lw_robot_variable_count( checker->base->robot ),
		.shapes = scene_shapes + spare_shapes };
	const size_t rows = (size_t)checker->base->moving_body_count + spare_bodies;
	const size_t environment = ( rows > 0 ? rows : 1 ) * lwi_padded( sizes.shapes );
	const size_t self_pairs = sizes.bodies * (size_t)sizes.bodies / 2 + 1;
	sizes.gaps = environment > self_pairs ? environment : self_pairs;
	return sizes;
}

lw_status lw_checker_state( const lw_checker* checker, lw_query* query, const double* q, lw_check_flags flags,
	const lw_range* range, bool stop_at_first, lw_state_result* out )
{
	if ( out == NULL )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	*out = ( lw_state_result ){ LW_VERDICT_UNKNOWN, lw_clearance_unknown(), lw_clearance_unknown() };
	lw_range wanted = range != NULL ? *range : lw_range_exact();
	if ( checker == NULL || query == NULL || ( q == NULL && checker->base->group.variable_count > 0 ) ||
		 !lwi_range_is_valid( &wanted ) || ( flags & LW_CHECK_BOTH ) == 0 || !lwi_query_fits( query, checker ) )
	{
		return LW_ERROR_INVALID_ARGUMENT;
	}
	query->search.failure = LW_OK;
	lw_status status = lwi_checker_pose( checker, query, q );
	if ( status != LW_OK )
	{
		return status;
	}
	bool ask_environment = ( flags & LW_CHECK_ENVIRONMENT ) != 0, ask_self = ( flags & LW_CHECK_SELF ) != 0;
	if ( ask_environment )
	{
		lwi_checker_environment( checker, query, &wanted, &out->environment );
	}
	bool violated = out->environment.kind == LW_CLEARANCE_VIOLATION;
	if ( ask_self && !( violated && stop_at_first ) )
	{
		checker->self_unchanged ? (void)( out->self = lwi_nothing_to_check() )
								: lwi_checker_self( checker, query, &wanted, &out->self );
		violated = violated || out->self.kind == LW_CLEARANCE_VIOLATION;
	}
	if ( query->search.failure != LW_OK )
	{
		*out = ( lw_state_result ){ LW_VERDICT_UNKNOWN, lw_clearance_unknown(), lw_clearance_unknown() };
		return query->search.failure;
	}
	bool free = ( !ask_environment || is_proved_free( &out->environment, wanted.min_d ) ) &&
				( !ask_self || is_proved_free( &out->self, wanted.min_d ) );
	out->verdict = violated ? LW_VERDICT_BLOCKED : free ? LW_VERDICT_FREE : LW_VERDICT_UNDECIDED;
	return LW_OK;
}

/// The pair for which a state is not free: one that is too near before one that rounding decides.
static lw_state_reason reason_of( const lw_state_result* state )
{
	lw_state_reason reason = { state->verdict, false, lw_clearance_unknown() };
	if ( state->verdict == LW_VERDICT_BLOCKED || state->verdict == LW_VERDICT_UNDECIDED )
	{
		const lw_clearance_class sought =
			state->verdict == LW_VERDICT_BLOCKED ? LW_CLEARANCE_VIOLATION : LW_CLEARANCE_UNDECIDED;
		reason.self = state->environment.kind != sought;
		reason.pair = reason.self ? state->self : state->environment;
	}
	return reason;
}

lw_status lw_checker_is_free( const lw_checker* checker, lw_query* query, const double* q, lw_check_flags flags,
	double min_d, bool* out_free, lw_state_reason* out_reason )
{
	lw_state_result state = { LW_VERDICT_UNKNOWN, lw_clearance_unknown(), lw_clearance_unknown() };
	lw_status status = LW_ERROR_INVALID_ARGUMENT;
	if ( out_free != NULL )
	{
		const lw_range range = lw_range_threshold( min_d );
		status = lw_checker_state( checker, query, q, flags, &range, true, &state );
		*out_free = status == LW_OK && state.verdict == LW_VERDICT_FREE;
	}
	if ( out_reason != NULL )
	{
		*out_reason = reason_of( &state );
	}
	return status;
}
