// SPDX-License-Identifier: BSD-3-Clause
// The independent audit of a path.
//
// Between two measured states whose clearances are c1 and c2, and between which no robot point travels further than m, the
// clearance to a fixed obstacle stays above (c1 + c2 - m) / 2: a distance cannot change faster than the point moves. Both
// bodies of a self pair may move, so there it is (c1 + c2 - 2 m) / 2. The audit measures m and reports the least of these
// bounds; of the edge prover it uses only the exact distance of a single state.
#include "leeway/motions/audit.hpp"

#include "motions/names.hpp"

#include "leeway/ik/goal_states.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <iterator>
#include <map>

namespace leeway::motions
{
namespace
{

constexpr double infinity = std::numeric_limits<double>::infinity();
// A step may use this share of the room above the margin, so that states come denser the closer contact is.
constexpr double step_share = 0.25;
// Joint travel per step, summed over all joints, radians: no link turns further than this, so that the measured chord of a
// point's motion equals its arc to 1 - x / (2 sin(x / 2)) = 0.05 %, covered by arc_over_chord.
constexpr double joint_travel_per_step = 0.1;
constexpr double arc_over_chord = 1.001;
// Roundings of the ends in other programs' files, radians or metres.
constexpr double end_tolerance = 1e-9;
// More problems than this are only counted.
constexpr std::size_t problems_named = 5;

// A collision shape by its bounding sphere.
struct Ball
{
	std::uint32_t link;
	lw_vec3 center; // link frame
	double radius;
};

class MotionMeter
{
public:
	explicit MotionMeter( const io::Problem& problem ) : m_problem( problem )
	{
		const lw_robot* robot = problem.robot.get();
		for ( std::uint32_t i = 0; i < lw_robot_body_count( robot ); ++i )
		{
			const lw_body_def body = lw_robot_body( robot, i );
			const lw_shape_info info = lw_shape_get_info( body.shape );
			const lw_vec3 center = { info.sphere_center[0], info.sphere_center[1], info.sphere_center[2] };
			m_balls.push_back( { body.link, lw_transform_point( &body.link_from_shape, center ), info.sphere_radius } );
		}
	}

	std::vector<lw_transform> poses( const std::vector<double>& full ) const
	{
		std::vector<lw_transform> world_from_link( lw_robot_link_count( m_problem.robot.get() ) );
		require( lw_robot_fk( m_problem.robot.get(), full.data(), world_from_link.data() ), "forward kinematics" );
		return world_from_link;
	}

	// How far a robot point can have moved between two poses: |c' - c| + r 2 sin(angle / 2), where 2 sin(angle / 2) is the
	// Frobenius norm of the difference of the rotations over the root of 2 (no loss of digits at small angles).
	double motion( const std::vector<lw_transform>& a, const std::vector<lw_transform>& b ) const
	{
		double most = 0;
		for ( const Ball& ball : m_balls )
		{
			const lw_transform &pa = a[ball.link], &pb = b[ball.link];
			const lw_vec3 ca = lw_transform_point( &pa, ball.center ), cb = lw_transform_point( &pb, ball.center );
			double turn_sq = 0;
			for ( int i = 0; i < 3; ++i )
			{
				for ( int k = 0; k < 3; ++k )
				{
					turn_sq += ( pb.r[i][k] - pa.r[i][k] ) * ( pb.r[i][k] - pa.r[i][k] );
				}
			}
			const double shift = std::hypot( cb.x - ca.x, cb.y - ca.y, cb.z - ca.z );
			most = std::max( most, shift + ball.radius * std::sqrt( turn_sq / 2 ) );
		}
		return arc_over_chord * most;
	}

private:
	const io::Problem& m_problem;
	std::vector<Ball> m_balls;
};

double now()
{
	return std::chrono::duration<double>( std::chrono::steady_clock::now().time_since_epoch() ).count();
}

// One audit in progress.
class Auditor
{
public:
	Auditor( const io::Problem& problem, const AuditSettings& settings, const std::string& file )
	    : m_problem( problem ), m_settings( settings ), m_file( file ), m_meter( problem ),
	      m_query( makeQuery( problem.checker.get() ) )
	{
		m_audit.environment.clearance = {
		    ( settings.flags & LW_CHECK_ENVIRONMENT ) != 0, infinity, infinity, "", "", {}, {}, false };
		m_audit.self.clearance = { ( settings.flags & LW_CHECK_SELF ) != 0, infinity, infinity, "", "", {}, {}, false };
		m_audit.environment_between = m_audit.self_between = infinity;
	}

	Audit run( const std::vector<std::vector<double>>& points )
	{
		const double start = now();
		std::vector<double> lengths;
		for ( std::size_t k = 0; k + 1 < points.size(); ++k )
		{
			lengths.push_back( jointDistance( m_problem, points[k], points[k + 1] ) );
			m_audit.length += lengths.back();
		}
		requireBounded( points );
		for ( std::size_t k = 0; k < points.size(); ++k )
		{
			limits( points[k], k );
		}
		m_full = fullState( m_problem, points[0] );
		m_poses = m_meter.poses( m_full );
		sample( { 0, 0, 0 }, 0 );
		double before = 0;
		for ( std::size_t k = 0; k < lengths.size() && !m_ended; ++k )
		{
			edge( k, points[k], points[k + 1], before, lengths[k], start );
			before += lengths[k];
		}
		m_audit.valid = m_count == 0;
		if ( m_count > problems_named )
		{
			m_audit.problems.push_back( fmt::format( "and {} more", m_count - problems_named ) );
		}
		m_audit.seconds = now() - start;
		return std::move( m_audit );
	}

private:
	double travel( const std::vector<double>& a, const std::vector<double>& b ) const
	{
		double sum = 0;
		for ( std::uint32_t i = 0; i < a.size(); ++i )
		{
			sum += std::abs( shorterWay( m_problem.robot.get(), i, a[i], b[i] ) );
		}
		return sum;
	}

	// A path along which joints travel without end is not begun.
	void requireBounded( const std::vector<std::vector<double>>& points ) const
	{
		double sum = 0;
		for ( std::size_t k = 0; k + 1 < points.size(); ++k )
		{
			sum += travel( fullState( m_problem, points[k] ), fullState( m_problem, points[k + 1] ) );
		}
		if ( !( sum / joint_travel_per_step <= AuditSettings::most_states ) )
		{
			throw io::Error( m_file, "the path",
			    fmt::format( "its joints travel {:.3g} radians or metres: an audit takes more than {:.0e} states", sum,
			        AuditSettings::most_states ),
			    "narrow the joints' limits in the URDF, or audit a part of the path" );
		}
	}

	// Reports progress, and ends the audit when its time is over.
	void watchTime( const PathPlace& place, double start )
	{
		constexpr std::size_t states_between = 64;
		if ( m_audit.states % states_between != 0 )
		{
			return;
		}
		const double spent = now() - start;
		report( m_settings.progress, "measuring states", place.s );
		if ( spent > m_settings.time )
		{
			m_ended = true;
			problem( fmt::format(
			    "the audit ended after {:.0f} s and {} states at {:.2g} % of the path, of which it would take about {:.0f} s: "
			    "give it more time (leeway audit --time), or a coarser --resolution",
			    spent, m_audit.states, 100 * place.s, spent / std::max( place.s, 1e-9 ) ) );
		}
	}

	void problem( const std::string& text )
	{
		if ( m_count++ < problems_named )
		{
			m_audit.problems.push_back( text );
		}
	}

	void limits( const std::vector<double>& q, std::size_t point )
	{
		for ( const std::string& violation : groupLimitViolations( m_problem, q, limit_tolerance ) )
		{
			problem( fmt::format( "point {}: {}", point, violation ) );
		}
	}

	// One clearance of a sample: keeps the least, reports violations, returns the clearance.
	double take( const char* which, const Named& clearance, const PathPlace& place, AuditLeast& least )
	{
		if ( clearance.least() < least.clearance.least() )
		{
			least.clearance = clearance;
			least.place = place;
		}
		// Written so that NaN is a violation.
		if ( !( clearance.lower > m_settings.min_d ) )
		{
			problem( fmt::format( "{} clearance {} m of {} - {} on edge {} at t {:.6f} is not above min-d {}{}", which,
			    clearance.least(), clearance.first, clearance.second, place.edge, place.t, m_settings.min_d,
			    clearance.marginText() ) );
		}
		return clearance.least();
	}

	// Measures the current state. `motion` is how far points moved since the last sample.
	void sample( const PathPlace& place, double motion )
	{
		const std::vector<double> q = groupState( m_problem, m_full );
		lw_state_result state;
		const lw_status status =
		    lw_checker_state( m_problem.checker.get(), m_query.get(), q.data(), m_settings.flags, nullptr, false, &state );
		if ( status != LW_OK )
		{
			throw io::Error( m_file, fmt::format( "edge {}", place.edge ),
			    std::string( "a state cannot be measured (" ) + lw_status_name( status ) + ")",
			    "check the points of the path" );
		}
		AuditSample now_ = { place, infinity, infinity }, proved = now_;
		if ( m_audit.environment.clearance.asked )
		{
			now_.environment = take(
			    "environment", nameEnvironment( m_problem.checker.get(), state.environment ), place, m_audit.environment );
			proved.environment = state.environment.lower;
		}
		if ( m_audit.self.clearance.asked )
		{
			now_.self = take( "self", nameSelf( m_problem.checker.get(), state.self ), place, m_audit.self );
			proved.self = state.self.lower;
		}
		if ( !m_audit.samples.empty() )
		{
			m_audit.environment_between =
			    std::min( m_audit.environment_between, ( m_proved.environment + proved.environment - motion ) / 2 );
			m_audit.self_between = std::min( m_audit.self_between, ( m_proved.self + proved.self - 2 * motion ) / 2 );
		}
		m_proved = proved;
		m_audit.samples.push_back( now_ );
		++m_audit.states;
	}

	double allowedMotion() const
	{
		const AuditSample& last = m_audit.samples.back();
		const double room = std::min( last.environment - m_settings.min_d, ( last.self - m_settings.min_d ) / 2 );
		return std::max( m_settings.resolution, step_share * room );
	}

	void edge( std::size_t index, const std::vector<double>& qa, const std::vector<double>& qb, double before, double length,
	    double start )
	{
		const std::vector<double> a = fullState( m_problem, qa ), b = fullState( m_problem, qb );
		const double way = travel( a, b );
		// without anything that could be touched, no bound comes from the motion between two states
		const bool is_dense = way > joint_travel_per_step && std::isfinite( allowedMotion() );
		const double longest = is_dense ? joint_travel_per_step / way : 1.0;
		double t = 0, step = longest;
		std::vector<double> next( a.size() );
		while ( t < 1 && !m_ended )
		{
			const double allowed = allowedMotion();
			std::vector<lw_transform> poses;
			double moved = infinity, at = 1;
			for ( step = std::min( step, longest );; step *= std::min( 0.9 * allowed / moved, 0.9 ) )
			{
				at = std::min( 1.0, t + step );
				lw_robot_interpolate( m_problem.robot.get(), a.data(), b.data(), at, next.data() );
				poses = m_meter.poses( next );
				moved = m_meter.motion( m_poses, poses );
				// The last ulps of t cannot be divided further: the step is taken, and `between` accounts for it.
				if ( moved <= allowed || step < 1e-12 )
				{
					break;
				}
			}
			t = at;
			m_full = next;
			m_poses = std::move( poses );
			const double total = m_audit.length > 0 ? m_audit.length : 1;
			sample( { index, t, ( before + t * length ) / total }, moved );
			watchTime( m_audit.samples.back().place, start );
			step *= moved > 0 ? std::clamp( 0.9 * allowedMotion() / moved, 0.1, 4.0 ) : 4.0;
		}
	}

	const io::Problem& m_problem;
	const AuditSettings& m_settings;
	const std::string& m_file;
	MotionMeter m_meter;
	Query m_query;
	Audit m_audit;
	AuditSample m_proved;    // lower bounds of the last sample
	std::size_t m_count = 0; // problems
	bool m_ended = false;    // its time is over
	std::vector<double> m_full;
	std::vector<lw_transform> m_poses;
};

std::string place( const PathPlace& where )
{
	return fmt::format( "edge {}, t {:.4f} ({:.1f} % of the way)", where.edge, where.t, 100 * where.s );
}

std::string leastLine( const char* which, const AuditLeast& least, double between )
{
	if ( !least.clearance.asked )
	{
		return fmt::format( "{:<12}not checked\n", which );
	}
	if ( least.clearance.first.empty() )
	{
		return fmt::format( "{:<12}nothing near, clearance {} m\n", which, least.clearance.lower );
	}
	return fmt::format( "{:<12}least {:.6f} m, {} - {}{}, on {}; between the measured states at least {:.6f} m\n", which,
	    least.clearance.least(), least.clearance.first, least.clearance.second, least.clearance.marginText(),
	    place( least.place ), between );
}

} // namespace

Audit auditPath( const io::Problem& problem, const std::vector<std::vector<double>>& points, const AuditSettings& settings,
    const std::string& file )
{
	return Auditor( problem, settings, file ).run( points );
}

void auditEnds(
    const io::Problem& problem, const io::Request& request, const std::vector<std::vector<double>>& points, Audit& audit )
{
	const auto add = [&audit]( const std::string& text )
	{
		audit.valid = false;
		audit.problems.push_back( text );
	};
	// The robot stands at the start's numbers: from there a controller without wrap-around drives whole turns that nobody proved.
	const std::vector<double> first = fullState( problem, points.front() );
	std::map<std::uint32_t, std::array<double, 3>>
	    rotations; // by joint: products of both quaternions, which may differ in sign and length
	for ( const auto& [name, wanted] : request.start.values )
	{
		const std::uint32_t variable = variableOf( problem.robot.get(), name );
		if ( variable == LW_INVALID_INDEX )
		{
			continue;
		}
		const double given = first[variable];
		const lw_variable_info info = lw_robot_variable( problem.robot.get(), variable );
		if ( info.component >= 3 )
		{
			std::array<double, 3>& products = rotations[info.joint];
			products = { products[0] + given * wanted, products[1] + given * given, products[2] + wanted * wanted };
		}
		else if ( !( std::fabs( given - wanted ) <= end_tolerance ) )
		{
			add( fmt::format(
			    "the path begins with joint {} at {:.17g}, and the request's start has {:.17g}", name, given, wanted ) );
		}
	}
	for ( const auto& [joint, products] : rotations )
	{
		if ( !( std::fabs( products[0] ) >= ( 1 - end_tolerance ) * std::sqrt( products[1] * products[2] ) ) )
		{
			add( fmt::format( "the path begins with another rotation of joint {} than the request's start",
			    lw_robot_joint_name( problem.robot.get(), joint ) ) );
		}
	}
	if ( !request.hasPoseGoal() )
	{
		const double difference = jointDistance( problem, io::goalState( problem, request ), points.back() );
		if ( !( difference <= end_tolerance ) )
		{
			add( fmt::format( "the path's goal is {:.3g} (joint space) away from the request's", difference ) );
		}
		return;
	}
	for ( const std::string& violation : ik::goalViolations( problem, request, points.back().data() ) )
	{
		add( fmt::format( "the path's goal is not the request's: {}", violation ) );
	}
}

std::vector<AuditSample> profile( const Audit& audit, std::size_t stretches )
{
	std::vector<AuditSample> least;
	for ( const AuditSample& sample : audit.samples )
	{
		const std::size_t stretch =
		    std::min( stretches - 1, static_cast<std::size_t>( sample.place.s * double( stretches ) ) );
		while ( least.size() <= stretch )
		{
			least.push_back( { sample.place, infinity, infinity } );
			least.back().place.s = double( least.size() - 1 ) / double( stretches );
		}
		least[stretch].environment = std::min( least[stretch].environment, sample.environment );
		least[stretch].self = std::min( least[stretch].self, sample.self );
	}
	return least;
}

std::string describe( const Audit& audit, const AuditSettings& settings, std::size_t points )
{
	std::string text = fmt::format( "path        {}, length {:.6g}\n", counted( points, "state" ), audit.length );
	text += fmt::format(
	    "audit       {}: {} exact states in {:.2f} s; between two of them no robot point moves more than {:g} mm "
	    "or a quarter of the room above min-d {:g} m\n",
	    audit.valid ? "VALID" : "NOT VALID", audit.states, audit.seconds, 1000 * settings.resolution, settings.min_d );
	for ( const std::string& problem : audit.problems )
	{
		text += fmt::format( "            {}\n", problem );
	}
	text += leastLine( "environment", audit.environment, audit.environment_between );
	text += leastLine( "self", audit.self, audit.self_between );
	text += "profile     least clearance in each twentieth of the length, millimetres\n";
	std::string environment = "environment", self = "self       ";
	for ( const AuditSample& part : profile( audit, 20 ) )
	{
		fmt::format_to( std::back_inserter( environment ), " {:5.0f}", 1000 * part.environment );
		fmt::format_to( std::back_inserter( self ), " {:5.0f}", 1000 * part.self );
	}
	text += audit.environment.clearance.asked ? environment + "\n" : "";
	text += audit.self.clearance.asked ? self + "\n" : "";
	return text;
}

std::string profileCsv( const Audit& audit )
{
	std::string text = "s,edge,t,environment,self\n";
	for ( const AuditSample& sample : audit.samples )
	{
		fmt::format_to( std::back_inserter( text ), "{},{},{},{},{}\n", sample.place.s, sample.place.edge, sample.place.t,
		    sample.environment, sample.self );
	}
	return text;
}

} // namespace leeway::motions
