// SPDX-License-Identifier: BSD-3-Clause
// The core's interface as a structured fuzzer: bytes choose calls, and arguments from among valid ones and those that make
// no sense. Every object comes from one counting allocator, which may be told to fail.
//
// Promises that are checked: a status and an outcome go together, errors have no verdict and the interval of an error,
// intervals are intervals, the same pair measured both ways gives intervals that meet, and nothing is left when all is
// released.
#include "fuzz.hpp"

#include "core_world.hpp"

namespace fuzz
{

namespace
{

class Calls : CoreWorld
{
public:
	explicit Calls( Input input ) : CoreWorld( input ) {}

	void run()
	{
		for ( int i = 0; i < 96 && !m_bytes.empty(); ++i )
		{
			call();
		}
	}

private:
	void call()
	{
		switch ( m_bytes.below( 24 ) )
		{
		case 0:
		case 1:
			return addPrimitive();
		case 2:
			return addMesh();
		case 3:
			return addSet();
		case 4:
			return addDeferred();
		case 5:
			return addDetail();
		case 6:
		case 7:
			return addScene();
		case 8:
			return editScene();
		case 9:
		case 10:
			return addRobot();
		case 11:
			return changeAttached();
		case 12:
		case 13:
			return addChecker();
		case 14:
			return editChecker();
		case 15:
			return addQuery();
		case 16:
		case 17:
			return measureShapes();
		case 18:
			return checkState();
		case 19:
			return checkEdge();
		case 20:
			return saveAndRead();
		case 21:
			return lookAtRobot();
		case 22:
			return addReach();
		default:
			return m_bytes.below( 4 ) == 0 ? failSoon() : releaseSomething();
		}
	}

	lw_range range()
	{
		lw_range range = {
		    m_bytes.oneIn( 3 ) ? real() : 0.0, m_bytes.oneIn( 2 ) ? real() : INFINITY, m_bytes.oneIn( 3 ) ? real() : 0.0 };
		return range;
	}

	static void checkInterval( lw_status status, const lw_clearance& c )
	{
		if ( status != LW_OK )
		{
			expect( c.kind == LW_CLEARANCE_UNKNOWN && c.lower <= 0 && c.upper == INFINITY,
			    "an error never reads as free space" );
			return;
		}
		expect( c.lower <= c.upper, "a clearance is an interval" );
		expect( !std::isnan( c.lower ) && !std::isnan( c.upper ), "a clearance is made of numbers" );
		expect( std::isinf( c.upper ) || ( std::isfinite( c.point_a.x + c.point_a.y + c.point_a.z ) &&
		                                     std::isfinite( c.point_b.x + c.point_b.y + c.point_b.z ) ),
		    "witnesses of a finite distance are points" );
	}

	void measureShapes()
	{
		const lw_shape *a = pick( m_shapes ), *b = pick( m_shapes );
		lw_query* query = pick( m_queries );
		const lw_transform at_a = pose(), at_b = pose();
		const lw_range asked = range();
		const bool exact = m_bytes.oneIn( 2 );
		const long left = allocator()->left;
		lw_clearance ab = lw_clearance_unknown(), ba = ab;
		const lw_status status = lw_shape_distance( a, &at_a, b, &at_b, exact ? nullptr : &asked, query, &ab );
		checkInterval( status, ab );
		const lw_status swapped = lw_shape_distance( b, &at_b, a, &at_a, exact ? nullptr : &asked, query, &ba );
		checkInterval( swapped, ba );
		// A deferred mesh may have been refused memory the first time
		expect( ( status == LW_OK ) == ( swapped == LW_OK ) || left >= 0, "both orders of a pair are answered, or none" );
		if ( status == LW_OK && exact && m_tame )
		{
			const double slack = 1e-9;
			expect(
			    ab.lower <= ba.upper + slack && ba.lower <= ab.upper + slack, "both orders of a pair have one distance" );
		}
	}

	std::vector<double> stateOf( const lw_checker* checker, bool calm )
	{
		std::vector<double> q( checker != nullptr ? lw_checker_variable_count( checker ) : 4 );
		for ( double& value : q )
		{
			value = calm ? m_bytes.between( -2, 2 ) : real();
		}
		return q;
	}

	void checkState()
	{
		const lw_checker* checker = pick( m_checkers );
		lw_query* query = pick( m_queries );
		std::vector<double> q = stateOf( checker, m_bytes.oneIn( 2 ) );
		const lw_range asked = range();
		lw_state_result result;
		const lw_check_flags flags = static_cast<lw_check_flags>( m_bytes.below( 4 ) );
		const lw_status status = lw_checker_state(
		    checker, query, q.data(), flags, m_bytes.oneIn( 2 ) ? nullptr : &asked, m_bytes.oneIn( 2 ), &result );
		checkInterval( status, result.environment );
		checkInterval( status, result.self );
		expect( status == LW_OK || result.verdict == LW_VERDICT_UNKNOWN, "an error has no verdict" );
		expect( status != LW_OK || result.verdict != LW_VERDICT_UNKNOWN, "a state that was checked has a verdict" );
	}

	/// The cost of an edge is its motion over its slack (or step): both are kept such that it ends soon, or are refused.
	void checkEdge()
	{
		const lw_checker* checker = pick( m_checkers );
		lw_query* query = pick( m_queries );
		const std::vector<double> qa = stateOf( checker, true );
		const std::vector<double> qb = m_tame ? stateOf( checker, !m_bytes.oneIn( 8 ) ) : qa;
		lw_edge_def def = lw_edge_def_default();
		def.method = m_bytes.oneIn( 8 )   ? static_cast<lw_edge_method>( m_bytes.below( 4 ) )
		             : m_bytes.oneIn( 3 ) ? LW_EDGE_STEPS
		                                  : LW_EDGE_CERTIFIED;
		def.flags = static_cast<lw_check_flags>( m_bytes.oneIn( 8 ) ? 0 : 1 + m_bytes.below( 3 ) );
		def.min_d = m_bytes.oneIn( 2 ) ? 0.0 : m_bytes.between( -0.1, 1 );
		const double odd[] = { 0, -1, NAN, INFINITY, 1e300 };
		def.slack = m_bytes.oneIn( 4 ) ? odd[m_bytes.below( 5 )] : m_bytes.between( 0.02, 0.5 );
		def.max_d = m_bytes.oneIn( 4 ) ? odd[m_bytes.below( 5 )] : m_bytes.between( 0.1, 0.5 );
		def.alpha = m_bytes.oneIn( 4 ) ? m_bytes.between( -0.5, 1.5 ) : 0.0;
		def.want_proved_until = m_bytes.oneIn( 2 );
		for ( double value : qb ) // motion of thousands of metres is no sin, but takes its time
		{
			if ( std::fabs( value ) > 10 )
			{
				return;
			}
		}
		lw_edge_result result;
		const lw_status status = lw_checker_edge( checker, query, qa.data(), qb.data(), &def, &result );
		expect( ( status == LW_OK ) == ( result.verdict != LW_VERDICT_UNKNOWN ),
		    "an edge has a verdict if and only if it is LW_OK" );
		expect(
		    status != LW_OK || ( result.t >= 0 && result.t <= 1 && result.proved_until >= 0 && result.proved_until <= 1 ),
		    "an edge's parameters are in [0, 1]" );
		expect( result.verdict != LW_VERDICT_FREE || def.method != LW_EDGE_CERTIFIED || result.lower_bound > def.min_d,
		    "a free edge is proved beyond the margin" );
		checkCurve( checker, query, qa, qb, def );
	}

	/// A curve between the same states, with a tolerance; takes no bytes, so that older inputs mean the same.
	void checkCurve( const lw_checker* checker, lw_query* query, const std::vector<double>& qa,
	    const std::vector<double>& qb, lw_edge_def def )
	{
		std::vector<double> points = qa, tolerance;
		for ( std::size_t i = 0; i < qa.size(); ++i )
		{
			points.push_back( qa[i] + 0.75 * ( qb[i] - qa[i] ) );
			tolerance.push_back( qa[i] == qb[i] ? 0 : std::fmod( qa[i], 0.015625 ) ); // negative ones are refused
		}
		points.insert( points.end(), qb.begin(), qb.end() );
		def.tolerance = tolerance.data();
		lw_edge_result result;
		const lw_status status = lw_checker_curve( checker, query, points.data(), 2, &def, &result );
		expect( ( status == LW_OK ) == ( result.verdict != LW_VERDICT_UNKNOWN ),
		    "a curve has a verdict if and only if it is LW_OK" );
		expect( status != LW_OK || ( result.t >= 0 && result.t <= 1 && result.proved_until <= result.t ),
		    "a curve is proved until its violation at most" );
		expect( result.verdict != LW_VERDICT_FREE || result.lower_bound > def.min_d,
		    "a free curve is proved beyond the margin" );
	}
};

} // namespace

void coreCalls( Input input )
{
	FailingAllocator allocator;
	CoreWorld::allocator() = &allocator;
	{
		Calls calls( input );
		calls.run();
	}
	expect( allocator.live == 0 && allocator.bytes == 0, "everything that was allocated is given back, with its size" );
}

} // namespace fuzz
