// SPDX-License-Identifier: BSD-3-Clause
// Newton steps onto constraints (Levenberg 1944; Berenson, Srinivasa, Kuffner, Task Space Regions, IJRR 2011), joints at their limits left out.
#include "leeway/manifold/manifold.hpp"

#include "ik/chain.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace leeway::manifold
{
namespace
{

using Eigen::Matrix3d;
using Eigen::Vector3d;
using State = Eigen::VectorXd;

constexpr double thin_half = 0.02;     // metres or radians: half of a thin range is below this
constexpr double inner_range = 0.9;    // of other ranges
constexpr double joint_share = 1e-3;   // of a joint's range, and of a joint constraint's, at each of its ends
constexpr double turn_length = 0.2;    // metres that count as much as a radian
constexpr double solved_error = 1e-11; // metres, or radians times turn_length
constexpr double touching = 1e-9;      // metres or radians, of a limit
constexpr int most_steps = 40;
constexpr double longest_change = 0.5; // radians or metres of one joint
constexpr double least_damping = 1e-14;
constexpr double step_damping = 1e-9;
constexpr double poor_damping = 1e-4;
constexpr double no_derivative = 1e-9; // of Euler angles near a pitch of a quarter turn

/// A coordinate of a pose, and its range.
struct Row
{
	std::size_t pose; ///< constraint
	int limit;        ///< lw_region_limit: positions and turns
	double lower, upper, inner_lower, inner_upper;
	bool thin;

	bool isPosition() const { return limit <= LW_REGION_Z; }
	double error( double value ) const { return value - std::clamp( value, inner_lower, inner_upper ); }
};

Row rowOf( std::size_t pose, int limit, double lower, double upper )
{
	const double middle = 0.5 * ( lower + upper ), half = 0.5 * ( upper - lower );
	const bool thin = half < thin_half;
	const double inner = thin ? 0 : inner_range * half;
	return { pose, limit, lower, upper, middle - inner, middle + inner, thin };
}

/// From the angular velocity in B to the changes of the turns.
Matrix3d ratesOfTurns( const lw_region_def& def, const lw_region_errors& errors )
{
	const Vector3d angles( errors.value[LW_REGION_TURN_X], errors.value[LW_REGION_TURN_Y], errors.value[LW_REGION_TURN_Z] );
	if ( def.turns_are == LW_TURNS_VECTOR )
	{
		return ik::inverseRightJacobian( angles );
	}
	const Matrix3d turns = ik::turnsOfEulerXyz( angles );
	return std::fabs( turns.determinant() ) > no_derivative ? Matrix3d( turns.inverse() ) : Matrix3d( turns.transpose() );
}

} // namespace

struct Manifold::Parts
{
	motions::BoundConstraints constraints;
	ik::Chain chain;
	std::vector<ik::ChainFrame> bases, tips; ///< of poses
	std::vector<Row> rows;
	State lower, upper;
	State inner_lower, inner_upper; ///< of projected states: a curve along a limit has no room to bend
	ik::Twists twists;
	std::vector<lw_region_errors> errors; ///< of poses
	State values;                         ///< of rows
	Eigen::MatrixXd jacobian;             ///< [rows][variables], of the values

	Parts( const io::RobotModel& robot, const io::Problem& problem, const io::PathConstraints& path )
	    : constraints( problem, path ), chain( robot, problem )
	{
		for ( const ik::Freedom& freedom : chain.freedoms() )
		{
			if ( freedom.turn >= 0 )
			{
				throw io::Error( robot.urdf_file, "group " + problem.group,
				    "has a floating joint, which no plan with path_constraints moves", "choose a group without it" );
			}
		}
		setBounds( problem, path );
		const std::vector<motions::PoseConstraint>& poses = constraints.poses();
		errors.resize( poses.size() );
		for ( std::size_t i = 0; i < poses.size(); ++i )
		{
			const lw_region_def& def = poses[i].def;
			bases.push_back( chain.add( { def.base_link, def.base_from_a } ) );
			tips.push_back( chain.add( { def.link, def.link_from_b } ) );
			poses[i].region ? addRows( i, def ) : void();
		}
		const auto count = static_cast<Eigen::Index>( problem.variables.size() );
		twists.resize( 6, count );
		values.resize( static_cast<Eigen::Index>( rows.size() ) );
		jacobian.resize( static_cast<Eigen::Index>( rows.size() ), count );
	}

	void setBounds( const io::Problem& problem, const io::PathConstraints& path )
	{
		const auto count = static_cast<Eigen::Index>( problem.variables.size() );
		lower.resize( count );
		upper.resize( count );
		for ( Eigen::Index i = 0; i < count; ++i )
		{
			const lw_variable_info info =
			    lw_robot_variable( problem.robot.get(), problem.variables[static_cast<std::size_t>( i )] );
			lower[i] = info.wraps ? -HUGE_VAL : info.lower;
			upper[i] = info.wraps ? HUGE_VAL : info.upper;
		}
		const std::vector<double> start = io::startState( problem );
		for ( const motions::JointRange& joint : constraints.joints() )
		{
			if ( !joint.moves )
			{
				continue;
			}
			const auto k = static_cast<Eigen::Index>( joint.entry );
			const double room = joint_share * ( joint.below + joint.above );
			const double middle = joint.middle + joint.turnsAt( start[joint.entry] );
			lower[k] = std::max( lower[k], middle - joint.below + room );
			upper[k] = std::min( upper[k], middle + joint.above - room );
			if ( !( lower[k] < upper[k] ) )
			{
				throw io::Error( path.file, joint.element,
				    "has no room within the joint's limits, or within its other constraints", "give ranges that overlap" );
			}
		}
		inner_lower = lower;
		inner_upper = upper;
		for ( Eigen::Index i = 0; i < count; ++i )
		{
			const double room = std::isfinite( upper[i] - lower[i] ) ? joint_share * ( upper[i] - lower[i] ) : 0;
			inner_lower[i] += room;
			inner_upper[i] -= room;
		}
	}

	void addRows( std::size_t pose, const lw_region_def& def )
	{
		for ( int i = 0; i < 3; ++i )
		{
			if ( std::isfinite( def.upper[i] - def.lower[i] ) )
			{
				rows.push_back( rowOf( pose, LW_REGION_X + i, def.lower[i], def.upper[i] ) );
			}
			const double largest = def.turns_are == LW_TURNS_XYZ && i == 1 ? 0.5 * M_PI : M_PI;
			if ( def.turns[i] < largest )
			{
				rows.push_back( rowOf( pose, LW_REGION_TURN_X + i, -def.turns[i], def.turns[i] ) );
			}
		}
	}

	void measure( const double* q )
	{
		for ( std::size_t i = 0; i < errors.size(); ++i )
		{
			const motions::PoseConstraint& pose = constraints.poses()[i];
			pose.region ? require( lw_region_state( pose.region.get(), q, 0, &errors[i] ), pose.element.c_str() ) : void();
		}
		for ( std::size_t r = 0; r < rows.size(); ++r )
		{
			values[static_cast<Eigen::Index>( r )] = errors[rows[r].pose].value[rows[r].limit];
		}
	}

	/// After measure( q ).
	void derive( const double* q )
	{
		chain.place( q );
		std::size_t placed = SIZE_MAX;
		Eigen::MatrixXd positions, turns;
		for ( std::size_t r = 0; r < rows.size(); ++r )
		{
			const Row& row = rows[r];
			if ( row.pose != placed )
			{
				placed = row.pose;
				const lw_region_def& def = constraints.poses()[placed].def;
				const ik::Pose base = chain.pose( bases[placed] ), tip = chain.pose( tips[placed] );
				twists.setZero();
				chain.addJacobian( tips[placed], tip.t, 1, twists );
				chain.addJacobian( bases[placed], tip.t, -1, twists );
				positions = ( base.r * ik::toPose( def.start ).r ).transpose() * twists.topRows<3>();
				turns = ratesOfTurns( def, errors[placed] ) * tip.r.transpose() * twists.bottomRows<3>();
			}
			const auto i = static_cast<Eigen::Index>( r );
			jacobian.row( i ) =
			    row.isPosition() ? positions.row( row.limit - LW_REGION_X ) : turns.row( row.limit - LW_REGION_TURN_X );
		}
	}

	/// The smallest change of joints that makes these changes of rows; rows of weight 0 and fixed joints are left out.
	State solved( const State& wanted, const State& weights, const std::vector<bool>& fixed, double damping ) const
	{
		Eigen::MatrixXd active = weights.asDiagonal() * jacobian;
		for ( std::size_t i = 0; i < fixed.size(); ++i )
		{
			fixed[i] ? static_cast<void>( active.col( static_cast<Eigen::Index>( i ) ).setZero() ) : void();
		}
		Eigen::MatrixXd normal = active * active.transpose();
		for ( Eigen::Index r = 0; r < weights.size(); ++r )
		{
			normal( r, r ) += weights[r] > 0 ? damping : 1;
		}
		return active.transpose() * normal.ldlt().solve( weights.cwiseProduct( wanted ) );
	}

	/// solved(), with joints fixed that would leave their bounds.
	State solvedWithin(
	    const State& wanted, const State& weights, const State& q, const State& besides, double damping ) const
	{
		std::vector<bool> fixed( static_cast<std::size_t>( q.size() ), false );
		State change;
		bool again = true;
		while ( again )
		{
			again = false;
			State rest = wanted, moved = besides;
			for ( Eigen::Index i = 0; i < q.size(); ++i )
			{
				moved[i] = fixed[static_cast<std::size_t>( i )] ? 0 : moved[i];
			}
			rest -= jacobian * moved;
			change = moved + solved( rest, weights, fixed, damping );
			for ( Eigen::Index i = 0; i < q.size(); ++i )
			{
				const bool out = ( change[i] < 0 && q[i] <= inner_lower[i] ) || ( change[i] > 0 && q[i] >= inner_upper[i] );
				if ( out && !fixed[static_cast<std::size_t>( i )] )
				{
					fixed[static_cast<std::size_t>( i )] = again = true;
				}
			}
		}
		return change;
	}

	double weightOf( const Row& row ) const { return row.isPosition() ? 1 : turn_length; }

	bool project( State& q )
	{
		q = q.cwiseMax( inner_lower ).cwiseMin( inner_upper );
		State wanted( values.size() ), weights( values.size() );
		const State none = State::Zero( q.size() );
		double before = HUGE_VAL;
		for ( int step = 0; step < most_steps; ++step )
		{
			measure( q.data() );
			for ( Eigen::Index r = 0; r < values.size(); ++r )
			{
				const Row& row = rows[static_cast<std::size_t>( r )];
				wanted[r] = -row.error( values[r] );
				weights[r] = row.thin || wanted[r] != 0 ? weightOf( row ) : 0;
			}
			const double error = weights.cwiseProduct( wanted ).norm();
			if ( !( error > solved_error ) )
			{
				return error <= solved_error;
			}
			derive( q.data() );
			const double damping = error > before ? poor_damping : least_damping + step_damping * error * error;
			const State change = solvedWithin( wanted, weights, q, none, damping );
			const double largest = change.size() > 0 ? change.cwiseAbs().maxCoeff() : 0;
			q += largest > longest_change ? State( longest_change / largest * change ) : change;
			q = q.cwiseMax( inner_lower ).cwiseMin( inner_upper );
			before = error;
		}
		return false;
	}

	void makeTangent( const State& q, State& direction )
	{
		measure( q.data() );
		derive( q.data() );
		State weights( values.size() );
		for ( Eigen::Index r = 0; r < values.size(); ++r )
		{
			weights[r] = rows[static_cast<std::size_t>( r )].thin ? weightOf( rows[static_cast<std::size_t>( r )] ) : 0;
		}
		const State still = State::Zero( values.size() ), wish = direction;
		for ( int round = 0; round < 2; ++round )
		{
			direction = solvedWithin( still, weights, q, wish, least_damping );
			const State rates = jacobian * direction;
			for ( Eigen::Index r = 0; r < values.size(); ++r )
			{
				const Row& row = rows[static_cast<std::size_t>( r )];
				const bool leaves = ( values[r] >= row.inner_upper - touching && rates[r] > 0 ) ||
				                    ( values[r] <= row.inner_lower + touching && rates[r] < 0 );
				weights[r] = row.thin || leaves ? weightOf( row ) : weights[r];
			}
		}
	}
};

Manifold::Manifold( const io::RobotModel& robot, const io::Problem& problem, const io::PathConstraints& path )
    : m_parts( std::make_unique<Parts>( robot, problem, path ) )
{
}
Manifold::~Manifold() = default;

std::size_t Manifold::variables() const
{
	return static_cast<std::size_t>( m_parts->lower.size() );
}
const double* Manifold::lower() const
{
	return m_parts->lower.data();
}
const double* Manifold::upper() const
{
	return m_parts->upper.data();
}
const motions::BoundConstraints& Manifold::constraints() const
{
	return m_parts->constraints;
}

bool Manifold::project( double* q )
{
	Eigen::Map<State> state( q, m_parts->lower.size() );
	State moved = state;
	const bool done = m_parts->project( moved );
	state = moved;
	return done;
}

void Manifold::makeTangent( const double* q, double* direction )
{
	Eigen::Map<State> wish( direction, m_parts->lower.size() );
	State moved = wish;
	m_parts->makeTangent( Eigen::Map<const State>( q, m_parts->lower.size() ), moved );
	wish = moved;
}

std::vector<std::string> Manifold::violations( const double* q )
{
	std::vector<std::string> lines;
	const auto add = [&lines]( const std::string& element, const std::string& name, double value, double excess )
	{
		if ( excess > -touching )
		{
			lines.push_back( fmt::format( "{}: {} is {:.6g}, {}", element, name, value,
			    excess > touching ? fmt::format( "by {:.3g} beyond its limit", excess ) : "at its limit" ) );
		}
	};
	for ( const motions::JointRange& joint : m_parts->constraints.joints() )
	{
		const double value = joint.moves ? q[joint.entry] : joint.stands,
		             off = value - joint.middle - joint.turnsAt( value );
		add( joint.element, "joint " + joint.joint, joint.middle + off, std::max( off - joint.above, -off - joint.below ) );
	}
	m_parts->measure( q );
	for ( std::size_t r = 0; r < m_parts->rows.size(); ++r )
	{
		const Row& row = m_parts->rows[r];
		const double value = m_parts->values[static_cast<Eigen::Index>( r )];
		add( m_parts->constraints.poses()[row.pose].element,
		    lw_region_limit_name( static_cast<lw_region_limit>( row.limit ) ), value,
		    std::max( value - row.upper, row.lower - value ) );
	}
	return lines;
}

bool Manifold::isInRange( const double* q )
{
	m_parts->measure( q );
	for ( std::size_t r = 0; r < m_parts->rows.size(); ++r )
	{
		const double value = m_parts->values[static_cast<Eigen::Index>( r )];
		if ( !( value >= m_parts->rows[r].lower && value <= m_parts->rows[r].upper ) )
		{
			return false;
		}
	}
	return true;
}

std::size_t Manifold::rows() const
{
	return m_parts->rows.size();
}

std::size_t Manifold::thinRows() const
{
	return static_cast<std::size_t>(
	    std::count_if( m_parts->rows.begin(), m_parts->rows.end(), []( const Row& row ) { return row.thin; } ) );
}

void Manifold::errors( const double* q, double* values, double* jacobian )
{
	m_parts->measure( q );
	jacobian != nullptr ? m_parts->derive( q ) : void();
	for ( std::size_t r = 0; r < rows(); ++r )
	{
		const Row& row = m_parts->rows[r];
		const auto i = static_cast<Eigen::Index>( r );
		const double error = row.error( m_parts->values[i] );
		if ( values != nullptr )
		{
			values[r] = error;
		}
		for ( std::size_t v = 0; jacobian != nullptr && v < variables(); ++v )
		{
			jacobian[r * variables() + v] =
			    row.thin || error != 0 ? m_parts->jacobian( i, static_cast<Eigen::Index>( v ) ) : 0;
		}
	}
}

} // namespace leeway::manifold
