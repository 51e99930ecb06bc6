// SPDX-License-Identifier: BSD-3-Clause
// Newton steps onto constraints (Levenberg 1944; Berenson, Srinivasa, Kuffner, Task Space Regions, IJRR 2011), joints at their limits left out.
#include "leeway/manifold/manifold.hpp"

#include <Eigen/Cholesky>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace leeway::manifold
{
namespace
{

using State = Eigen::VectorXd;
using Derivatives = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr double thin_half = 0.02;   // metres or radians: half of a thin range is below this
constexpr double inner_range = 0.9;  // of other ranges
constexpr double joint_share = 1e-3; // of a joint's range, and of a joint constraint's, at each of its ends
constexpr double turn_length = 0.2;  // metres that count as much as a radian
constexpr double close_share = 1e-3; // of half a range: an error of a state that is led to it
constexpr double touching = 1e-9;    // metres or radians, of a limit
constexpr int most_steps = 40;
constexpr double longest_change = 0.5; // radians or metres of one joint
constexpr double least_damping = 1e-14;
constexpr double step_damping = 1e-9;
constexpr double poor_damping = 1e-4;

/// A coordinate of a pose, and its range.
struct Row
{
	std::size_t pose; ///< constraint
	int limit;        ///< lw_region_limit: positions and turns
	double lower, upper, inner_lower, inner_upper;
	double close; ///< an error that counts as none
	bool thin;

	bool isPosition() const { return limit <= LW_REGION_Z; }
	double error( double value ) const { return value - std::clamp( value, inner_lower, inner_upper ); }
};

Row rowOf( std::size_t pose, int limit, double lower, double upper )
{
	const double middle = 0.5 * ( lower + upper ), half = 0.5 * ( upper - lower );
	const bool thin = half < thin_half;
	const double inner = thin ? 0 : inner_range * half;
	return { pose, limit, lower, upper, middle - inner, middle + inner, close_share * half, thin };
}

/// Rows of a pose follow each other in the order of lw_region_limit.
struct Rows
{
	std::uint32_t errors; ///< bit mask, 1 << lw_region_limit
	std::size_t first;
};

} // namespace

struct Manifold::Parts
{
	motions::BoundConstraints constraints;
	std::vector<Row> rows;
	State lower, upper;
	State inner_lower, inner_upper; ///< of projected states: a curve along a limit has no room to bend
	std::vector<Rows> of_poses;
	State values;         ///< of rows
	Derivatives jacobian; ///< [rows][variables], of the values
	State measured;       ///< where the derivatives are from; not a number: nowhere
	// of one step
	State wanted, weights, change, moved, right, part;
	std::vector<char> fixed; ///< [variables]
	Derivatives active;
	Eigen::MatrixXd normal;
	Eigen::LDLT<Eigen::MatrixXd> solver;

	Parts( const io::RobotModel& robot, const io::Problem& problem, const io::PathConstraints& path )
	    : constraints( problem, path )
	{
		for ( const std::uint32_t variable : problem.variables )
		{
			const lw_robot* r = problem.robot.get();
			if ( lw_robot_joint_type( r, lw_robot_variable( r, variable ).joint ) == LW_JOINT_FLOATING )
			{
				throw io::Error( robot.urdf_file, "group " + problem.group,
				    "has a floating joint, which no plan with path_constraints moves", "choose a group without it" );
			}
		}
		setBounds( problem, path );
		const std::vector<motions::PoseConstraint>& poses = constraints.poses();
		for ( std::size_t i = 0; i < poses.size(); ++i )
		{
			of_poses.push_back( { 0, rows.size() } );
			poses[i].region ? addRows( i, poses[i].def ) : void();
		}
		const auto count = static_cast<Eigen::Index>( problem.variables.size() ),
		           most = static_cast<Eigen::Index>( rows.size() );
		for ( State* of_rows : { &values, &wanted, &weights, &right } )
		{
			of_rows->setZero( most );
		}
		jacobian.setZero( most, count );
		measured.setConstant( count, NAN );
		active.setZero( most, count );
		normal.setZero( most, most );
		fixed.resize( problem.variables.size() );
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

	void addRow( std::size_t pose, int limit, double lower_end, double upper_end )
	{
		rows.push_back( rowOf( pose, limit, lower_end, upper_end ) );
		of_poses[pose].errors |= 1U << limit;
	}

	void addRows( std::size_t pose, const lw_region_def& def )
	{
		for ( int i = 0; i < 3; ++i )
		{
			std::isfinite( def.upper[i] - def.lower[i] ) ? addRow( pose, LW_REGION_X + i, def.lower[i], def.upper[i] )
			                                             : void();
		}
		for ( int i = 0; i < 3; ++i )
		{
			const double largest = def.turns_are == LW_TURNS_XYZ && i == 1 ? 0.5 * M_PI : M_PI;
			def.turns[i] < largest ? addRow( pose, LW_REGION_TURN_X + i, -def.turns[i], def.turns[i] ) : void();
		}
	}

	/// Values of rows, and their derivatives, which are kept for the next question: a walk takes the tangent where project() has ended.
	void measure( const double* q, bool derive )
	{
		const Eigen::Map<const State> at( q, measured.size() );
		if ( derive && measured == at )
		{
			return;
		}
		measured.setConstant( NAN );
		for ( std::size_t i = 0; i < of_poses.size(); ++i )
		{
			const motions::PoseConstraint& pose = constraints.poses()[i];
			const Rows& of = of_poses[i];
			double* const to = jacobian.data() + of.first * static_cast<std::size_t>( jacobian.cols() );
			of.errors == 0 ? void()
			               : require( lw_region_rows( pose.region.get(), q, 0, of.errors, values.data() + of.first,
			                              derive ? to : nullptr ),
			                     pose.element.c_str() );
		}
		derive ? static_cast<void>( measured = at ) : void();
	}

	/// change = moved + the smallest further change of joints, so that rows change as wanted. Rows of weight 0 and fixed joints are left out.
	void solve( double damping )
	{
		Eigen::Index count = 0;
		for ( Eigen::Index r = 0; r < weights.size(); ++r )
		{
			if ( weights[r] > 0 )
			{
				active.row( count ) = weights[r] * jacobian.row( r );
				right[count] = weights[r] * wanted[r] - active.row( count ).dot( moved );
				++count;
			}
		}
		change = moved;
		if ( count == 0 )
		{
			return;
		}
		for ( Eigen::Index i = 0; i < change.size(); ++i )
		{
			fixed[static_cast<std::size_t>( i )] ? static_cast<void>( active.col( i ).head( count ).setZero() ) : void();
		}
		for ( Eigen::Index r = 0; r < count; ++r )
		{
			for ( Eigen::Index k = 0; k <= r; ++k )
			{
				normal( r, k ) = normal( k, r ) = active.row( r ).dot( active.row( k ) ) + ( r == k ? damping : 0 );
			}
		}
		solver.compute( normal.topLeftCorner( count, count ) );
		part = solver.solve( right.head( count ) );
		change.noalias() += active.topRows( count ).transpose() * part;
	}

	/// solve() of a change `besides`, with joints fixed that would leave their bounds.
	void solveWithin( const State& q, const State& besides, double damping )
	{
		std::fill( fixed.begin(), fixed.end(), 0 );
		moved = besides;
		bool again = true;
		while ( again )
		{
			again = false;
			solve( damping );
			for ( Eigen::Index i = 0; i < q.size(); ++i )
			{
				const bool out = ( change[i] < 0 && q[i] <= inner_lower[i] ) || ( change[i] > 0 && q[i] >= inner_upper[i] );
				if ( out && !fixed[static_cast<std::size_t>( i )] )
				{
					fixed[static_cast<std::size_t>( i )] = again = true;
					moved[i] = 0;
				}
			}
		}
	}

	double weightOf( const Row& row ) const { return row.isPosition() ? 1 : turn_length; }

	bool project( State& q, double most )
	{
		q = q.cwiseMax( inner_lower ).cwiseMin( inner_upper );
		const State none = State::Zero( q.size() );
		double before = HUGE_VAL;
		for ( int step = 0; step < most_steps; ++step )
		{
			measure( q.data(), true );
			double square = 0;
			bool close = true;
			for ( Eigen::Index r = 0; r < values.size(); ++r )
			{
				const Row& row = rows[static_cast<std::size_t>( r )];
				wanted[r] = -row.error( values[r] );
				weights[r] = row.thin || wanted[r] != 0 ? weightOf( row ) : 0;
				square += weights[r] * weights[r] * wanted[r] * wanted[r];
				close = close && std::fabs( wanted[r] ) <= std::min( row.close, most );
			}
			if ( close )
			{
				return true;
			}
			const double error = std::sqrt( square );
			solveWithin( q, none, error > before ? poor_damping : least_damping + step_damping * square );
			const double largest = change.size() > 0 ? change.cwiseAbs().maxCoeff() : 0;
			q += ( largest > longest_change ? longest_change / largest : 1 ) * change;
			q = q.cwiseMax( inner_lower ).cwiseMin( inner_upper );
			before = error;
		}
		return false;
	}

	void makeTangent( const State& q, State& direction )
	{
		measure( q.data(), true );
		wanted.setZero();
		for ( Eigen::Index r = 0; r < values.size(); ++r )
		{
			weights[r] = rows[static_cast<std::size_t>( r )].thin ? weightOf( rows[static_cast<std::size_t>( r )] ) : 0;
		}
		solveWithin( q, direction, least_damping );
		bool more = false;
		for ( Eigen::Index r = 0; r < values.size(); ++r )
		{
			const Row& row = rows[static_cast<std::size_t>( r )];
			const double rate = row.thin ? 0 : jacobian.row( r ).dot( change );
			const bool leaves = ( values[r] >= row.inner_upper - 2 * row.close && rate > 0 ) ||
			                    ( values[r] <= row.inner_lower + 2 * row.close && rate < 0 );
			weights[r] = leaves ? weightOf( row ) : weights[r];
			more = more || leaves;
		}
		more ? solveWithin( q, direction, least_damping ) : void();
		direction = change;
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

bool Manifold::project( double* q, double most )
{
	Eigen::Map<State> state( q, m_parts->lower.size() );
	State moved = state;
	const bool done = m_parts->project( moved, most );
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
	m_parts->measure( q, false );
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
	m_parts->measure( q, false );
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
	m_parts->measure( q, jacobian != nullptr );
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
