// SPDX-License-Identifier: BSD-3-Clause
// Builds the OMPL state space of a checker's group.
#include "leeway/ompl/validity.hpp"

#include <ompl/base/ProjectionEvaluator.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/base/spaces/SE2StateSpace.h>
#include <ompl/base/spaces/SE3StateSpace.h>
#include <ompl/base/spaces/SO2StateSpace.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace leeway::ompl
{

namespace ob = ::ompl::base;

namespace
{

// Range given to a joint whose limits are equal, metres or radians. OMPL wants a hundredth of the extent of each subspace to
// be above 2e-16; a nanometre moves nothing that any clearance could notice.
constexpr double locked_range = 1e-9;

// The planners that keep a grid over a projection (KPIECE, PDST, EST, ...) need one. OMPL has no default for compound
// spaces, and that for RealVector spaces of one or two dimensions reads eight times as many numbers as there are, which
// aborts in builds with assertions such as Debian's (ompl/ompl#915, in 2.0.2 too): this one stands in for both. The first
// numbers are those of the joints next to the root, which move the most.
class LeadingNumbers : public ob::ProjectionEvaluator
{
public:
	LeadingNumbers( const ob::StateSpace* space, unsigned dimension )
	    : ob::ProjectionEvaluator( space ), m_dimension( dimension )
	{
	}
	unsigned int getDimension() const override { return m_dimension; }
	void project( const ob::State* state, Eigen::Ref<Eigen::VectorXd> projection ) const override
	{
		for ( unsigned i = 0; i < m_dimension; ++i )
		{
			projection( i ) = *space_->getValueAddressAtIndex( state, i );
		}
	}

private:
	unsigned m_dimension;
};

// A compound space that registers this projection itself, because setup() asks for it.
class GroupSpace : public ob::CompoundStateSpace
{
public:
	explicit GroupSpace( unsigned number_count ) : m_dimension( std::min( number_count, 3u ) ) {}
	void registerProjections() override
	{
		registerDefaultProjection( std::make_shared<LeadingNumbers>( this, m_dimension ) );
	}

private:
	unsigned m_dimension;
};

// The same for RealVector. Above two dimensions OMPL's own default, a random linear projection, is sound.
class JointSpace : public ob::RealVectorStateSpace
{
public:
	using ob::RealVectorStateSpace::RealVectorStateSpace;
	void registerProjections() override
	{
		if ( dimension_ > 2 )
		{
			ob::RealVectorStateSpace::registerProjections();
			return;
		}
		registerDefaultProjection( std::make_shared<LeadingNumbers>( this, dimension_ ) );
	}
};

struct Variable
{
	lw_variable_info info;
	std::string joint;
	lw_joint_type type;
};

std::vector<Variable> groupVariables( const Checker& checker )
{
	const lw_robot* robot = lw_checker_robot( checker.get() );
	std::vector<Variable> variables( lw_checker_variable_count( checker.get() ) );
	for ( std::uint32_t i = 0; i < variables.size(); ++i )
	{
		const lw_variable_info info = lw_robot_variable( robot, lw_checker_variable( checker.get(), i ) );
		variables[i] = { info, lw_robot_joint_name( robot, info.joint ), lw_robot_joint_type( robot, info.joint ) };
	}
	return variables;
}

void setBounds( ob::RealVectorBounds& bounds, unsigned index, const Variable& variable, double unbounded )
{
	double low = std::isinf( variable.info.lower ) ? -unbounded : variable.info.lower;
	double high = std::isinf( variable.info.upper ) ? unbounded : variable.info.upper;
	if ( !( low <= high ) )
	{
		throw std::invalid_argument( "leeway::ompl::makeStateSpace: joint " + variable.joint + " has no range between " +
		                             std::to_string( low ) + " and " + std::to_string( high ) +
		                             "; give it both limits or pass a larger `unbounded`" );
	}
	if ( high - low < locked_range )
	{
		low -= locked_range / 2;
		high += locked_range / 2;
	}
	bounds.setLow( index, low );
	bounds.setHigh( index, high );
}

ob::RealVectorBounds boundsOf( const std::vector<Variable>& variables, std::size_t first, unsigned count, double unbounded )
{
	ob::RealVectorBounds bounds( count );
	for ( unsigned i = 0; i < count; ++i )
	{
		setBounds( bounds, i, variables[first + i], unbounded );
	}
	return bounds;
}

// A planar or floating joint's variables must stand together and in order to be one subspace.
void requireTogether( const std::vector<Variable>& variables, std::size_t first, unsigned count )
{
	for ( unsigned i = 0; i < count; ++i )
	{
		const bool fits = first + i < variables.size() && variables[first + i].info.joint == variables[first].info.joint &&
		                  variables[first + i].info.component == i;
		if ( !fits )
		{
			throw std::invalid_argument( "leeway::ompl::makeStateSpace: the variables of joint " + variables[first].joint +
			                             " are not together and in order in the checker's state vector" );
		}
	}
}

std::shared_ptr<ob::StateSpace> makeVectorSpace( const std::vector<Variable>& variables, double unbounded )
{
	const auto count = static_cast<unsigned>( variables.size() );
	auto space = std::make_shared<JointSpace>( count );
	space->setBounds( boundsOf( variables, 0, count, unbounded ) );
	for ( unsigned i = 0; i < count; ++i )
	{
		space->setDimensionName( i, variables[i].joint );
	}
	return space;
}

// The subspace of the joint whose variables begin at `first`; advances `first` past them.
std::shared_ptr<ob::StateSpace> makeJointSpace(
    const std::vector<Variable>& variables, std::size_t& first, double unbounded )
{
	const Variable& variable = variables[first];
	std::shared_ptr<ob::StateSpace> result;
	std::size_t count = 1;
	if ( variable.type == LW_JOINT_PLANAR )
	{
		count = 3;
		requireTogether( variables, first, 3 );
		auto space = std::make_shared<ob::SE2StateSpace>();
		space->setBounds( boundsOf( variables, first, 2, unbounded ) );
		result = space;
	}
	else if ( variable.type == LW_JOINT_FLOATING )
	{
		count = 7;
		requireTogether( variables, first, 7 );
		auto space = std::make_shared<ob::SE3StateSpace>();
		space->setBounds( boundsOf( variables, first, 3, unbounded ) );
		result = space;
	}
	else if ( variable.info.wraps )
	{
		result = std::make_shared<ob::SO2StateSpace>();
	}
	else
	{
		result = makeVectorSpace( { variable }, unbounded );
	}
	result->setName( variable.joint );
	first += count;
	return result;
}

} // namespace

std::shared_ptr<ob::StateSpace> makeStateSpace( const Checker& checker, double unbounded )
{
	if ( !checker || lw_checker_variable_count( checker.get() ) == 0 )
	{
		throw std::invalid_argument( "leeway::ompl::makeStateSpace: no checker, or one without variables" );
	}
	if ( !( unbounded > 0 ) || std::isinf( unbounded ) )
	{
		throw std::invalid_argument( "leeway::ompl::makeStateSpace: `unbounded` must be finite and above 0" );
	}
	const std::vector<Variable> variables = groupVariables( checker );
	const bool plain = std::all_of( variables.begin(), variables.end(),
	    []( const Variable& variable )
	    { return !variable.info.wraps && variable.type != LW_JOINT_PLANAR && variable.type != LW_JOINT_FLOATING; } );
	const std::string name = lw_robot_name( lw_checker_robot( checker.get() ) );
	if ( plain )
	{
		std::shared_ptr<ob::StateSpace> space = makeVectorSpace( variables, unbounded );
		space->setName( name );
		return space;
	}
	auto space = std::make_shared<GroupSpace>( static_cast<unsigned>( variables.size() ) );
	for ( std::size_t first = 0; first < variables.size(); )
	{
		space->addSubspace( makeJointSpace( variables, first, unbounded ), 1.0 );
	}
	space->setName( name );
	space->lock();
	return space;
}

} // namespace leeway::ompl
