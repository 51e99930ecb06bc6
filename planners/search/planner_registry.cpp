// SPDX-License-Identifier: BSD-3-Clause
// OMPL's geometric planners by name: all that are made from a SpaceInformation alone.
#include "leeway/planners/planner_registry.hpp"

#include "leeway/io/model.hpp"
#include "leeway/planners/ompl_planner.hpp"

#include <ompl/base/ProjectionEvaluator.h>
#include <ompl/config.h>
#include <ompl/geometric/planners/AnytimePathShortening.h>
#include <ompl/geometric/planners/cforest/CForest.h>
#include <ompl/geometric/planners/est/BiEST.h>
#include <ompl/geometric/planners/est/EST.h>
#include <ompl/geometric/planners/est/ProjEST.h>
#include <ompl/geometric/planners/fmt/BFMT.h>
#include <ompl/geometric/planners/fmt/FMT.h>
#include <ompl/geometric/planners/informedtrees/ABITstar.h>
#include <ompl/geometric/planners/informedtrees/AITstar.h>
#include <ompl/geometric/planners/informedtrees/BITstar.h>
#include <ompl/geometric/planners/kpiece/BKPIECE1.h>
#include <ompl/geometric/planners/kpiece/KPIECE1.h>
#include <ompl/geometric/planners/kpiece/LBKPIECE1.h>
#include <ompl/geometric/planners/pdst/PDST.h>
#include <ompl/geometric/planners/prm/LazyPRM.h>
#include <ompl/geometric/planners/prm/LazyPRMstar.h>
#include <ompl/geometric/planners/prm/PRM.h>
#include <ompl/geometric/planners/prm/PRMstar.h>
#include <ompl/geometric/planners/prm/SPARS.h>
#include <ompl/geometric/planners/prm/SPARStwo.h>
#include <ompl/geometric/planners/rlrt/BiRLRT.h>
#include <ompl/geometric/planners/rlrt/RLRT.h>
#include <ompl/geometric/planners/rrt/BiTRRT.h>
#include <ompl/geometric/planners/rrt/InformedRRTstar.h>
#include <ompl/geometric/planners/rrt/LBTRRT.h>
#include <ompl/geometric/planners/rrt/LazyLBTRRT.h>
#include <ompl/geometric/planners/rrt/LazyRRT.h>
#include <ompl/geometric/planners/rrt/RRT.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/geometric/planners/rrt/RRTXstatic.h>
#include <ompl/geometric/planners/rrt/RRTsharp.h>
#include <ompl/geometric/planners/rrt/RRTstar.h>
#include <ompl/geometric/planners/rrt/SORRTstar.h>
#include <ompl/geometric/planners/rrt/TRRT.h>
#include <ompl/geometric/planners/rrt/pRRT.h>
#include <ompl/geometric/planners/sbl/SBL.h>
#include <ompl/geometric/planners/sbl/pSBL.h>
#include <ompl/geometric/planners/sst/SST.h>
#include <ompl/geometric/planners/stride/STRIDE.h>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>

namespace leeway::planners
{
namespace
{

namespace ob = ::ompl::base;
namespace og = ::ompl::geometric;

template <typename Planner> ob::PlannerPtr make( const ob::SpaceInformationPtr& si )
{
	return std::make_shared<Planner>( si );
}

std::string lower( std::string text )
{
	std::transform( text.begin(), text.end(), text.begin(), []( unsigned char c ) { return char( std::tolower( c ) ); } );
	return text;
}

// A fixed linear map of the state's numbers to the plane. Weights by the golden ratio: spread over [-1, 1] without random
// numbers, hence equal in every run.
class PlaneProjection : public ob::ProjectionEvaluator
{
public:
	explicit PlaneProjection( const ob::StateSpace* space ) : ob::ProjectionEvaluator( space ) {}
	unsigned int getDimension() const override { return 2; }
	void defaultCellSizes() override { cellSizes_.assign( 2, 0.1 ); }
	void project( const ob::State* state, Eigen::Ref<Eigen::VectorXd> projection ) const override
	{
		std::vector<double> numbers;
		space_->copyToReals( numbers, state );
		projection.setZero();
		for ( std::size_t i = 0; i < numbers.size(); ++i )
		{
			projection[0] += weight( 2 * i ) * numbers[i];
			projection[1] += weight( 2 * i + 1 ) * numbers[i];
		}
	}

private:
	static double weight( std::size_t i ) { return 2 * std::fmod( 0.6180339887498949 * double( i + 1 ), 1.0 ) - 1; }
};

/// Is a number within "least:most" or "least:step:most", or a word among "one,two"? Parameters without a range take anything that
/// OMPL can read.
bool isInRange( const std::string& value, const std::string& range )
{
	const std::size_t first = range.find( ':' ), last = range.rfind( ':' );
	if ( first == std::string::npos )
	{
		return range.empty() || ( "," + range + "," ).find( "," + value + "," ) != std::string::npos;
	}
	char* end = nullptr;
	const double number = std::strtod( value.c_str(), &end );
	return !value.empty() && *end == '\0' && number >= std::atof( range.substr( 0, first ).c_str() ) &&
	       number <= std::atof( range.substr( last + 1 ).c_str() );
}

} // namespace

const std::vector<PlannerEntry>& registry()
{
	static const std::vector<PlannerEntry> entries = {
	    { "Leeway", "first solution", make<planners::OmplPlanner>, "threads" },
	    { "RRTConnect", "first solution", make<og::RRTConnect> },
	    { "RRT", "first solution", make<og::RRT> },
	    { "LazyRRT", "first solution", make<og::LazyRRT> },
	    { "TRRT", "first solution", make<og::TRRT> },
	    { "BiTRRT", "first solution", make<og::BiTRRT> },
	    { "RLRT", "first solution", make<og::RLRT> },
	    { "BiRLRT", "first solution", make<og::BiRLRT> },
	    { "EST", "first solution", make<og::EST> },
	    { "BiEST", "first solution", make<og::BiEST> },
	    { "ProjEST", "first solution", make<og::ProjEST> },
	    { "KPIECE1", "first solution", make<og::KPIECE1> },
	    { "BKPIECE1", "first solution", make<og::BKPIECE1> },
	    { "LBKPIECE1", "first solution", make<og::LBKPIECE1> },
	    { "SBL", "first solution", make<og::SBL> },
	    { "STRIDE", "first solution", make<og::STRIDE> },
	    { "PDST", "first solution", make<og::PDST> },
	    { "FMT", "first solution", make<og::FMT> },
	    { "BFMT", "first solution", make<og::BFMT> },
	    { "PRM", "roadmap", make<og::PRM> },
	    { "LazyPRM", "roadmap", make<og::LazyPRM> },
	    { "SPARS", "roadmap", make<og::SPARS> },
	    { "SPARStwo", "roadmap", make<og::SPARStwo> },
	    { "PRMstar", "uses all the time", make<og::PRMstar> },
	    { "LazyPRMstar", "uses all the time", make<og::LazyPRMstar> },
	    { "RRTstar", "uses all the time", make<og::RRTstar> },
	    { "RRTsharp", "uses all the time", make<og::RRTsharp> },
	    { "RRTXstatic", "uses all the time", make<og::RRTXstatic> },
	    { "InformedRRTstar", "uses all the time", make<og::InformedRRTstar> },
	    { "SORRTstar", "uses all the time", make<og::SORRTstar> },
	    { "LBTRRT", "uses all the time", make<og::LBTRRT> },
	    { "LazyLBTRRT", "uses all the time", make<og::LazyLBTRRT> },
	    { "BITstar", "uses all the time", make<og::BITstar> },
	    { "ABITstar", "uses all the time", make<og::ABITstar> },
	    { "AITstar", "uses all the time", make<og::AITstar> },
	    { "SST", "uses all the time", make<og::SST> },
	    { "pRRT", "threads", make<og::pRRT>, "thread_count" },
	    { "pSBL", "threads", make<og::pSBL>, "thread_count" },
	    { "CForest", "threads", make<og::CForest>, "num_threads" },
	    { "AnytimePathShortening", "threads", make<og::AnytimePathShortening>, "num_planners" },
	};
	return entries;
}

const PlannerEntry& findPlanner( const std::string& name )
{
	std::string names;
	for ( const PlannerEntry& entry : registry() )
	{
		if ( lower( entry.name ) == lower( name ) )
		{
			return entry;
		}
		names += ( names.empty() ? "" : ", " ) + std::string( entry.name );
	}
	throw io::Error(
	    "command line", "--planner", fmt::format( "there is no planner '{}'", name ), "choose one of: " + names );
}

void requireThreads( const PlannerEntry& planner, unsigned threads )
{
	if ( threads > most_threads )
	{
		throw io::Error( "command line", "--threads", fmt::format( "{} is more than {}", threads, most_threads ),
		    "give as many as the machine has cores" );
	}
	if ( threads <= 1 || planner.threads != nullptr )
	{
		return;
	}
	std::string names;
	for ( const PlannerEntry& entry : registry() )
	{
		names += entry.threads == nullptr ? "" : ( names.empty() ? "" : ", " ) + std::string( entry.name );
	}
	throw io::Error( "command line", "--threads", fmt::format( "{} plans with one thread", planner.name ),
	    "leave it out, or choose a --planner of: " + names );
}

void setParameters( ob::Planner& planner, const std::vector<std::string>& assignments )
{
	ob::ParamSet& parameters = planner.params();
	const auto wrong = [&]( const std::string& problem )
	{
		std::string all;
		for ( const auto& [name, parameter] : parameters.getParams() )
		{
			const std::string range = parameter->getRangeSuggestion();
			all +=
			    ( all.empty() ? "" : ", " ) + name + "=" + parameter->getValue() + ( range.empty() ? "" : " in " + range );
		}
		throw io::Error( "command line", "--planner-param", problem,
		    all.empty() ? planner.getName() + " has no parameters: leave it out"
		                : "give NAME=VALUE of those of " + planner.getName() + ": " + all );
	};
	for ( const std::string& assignment : assignments )
	{
		const std::size_t middle = assignment.find( '=' );
		if ( middle == std::string::npos )
		{
			wrong( fmt::format( "'{}' has no '='", assignment ) );
		}
		const std::string name = assignment.substr( 0, middle ), value = assignment.substr( middle + 1 );
		if ( !parameters.hasParam( name ) )
		{
			wrong( fmt::format( "there is no parameter '{}'", name ) );
		}
		if ( !isInRange( value, parameters[name].getRangeSuggestion() ) || !parameters.setParam( name, value ) )
		{
			wrong( fmt::format( "'{}' is not a value for {}", value, name ) );
		}
	}
}

void ensureProjection( const ob::StateSpacePtr& space )
{
	// The default of vector spaces of one and two dimensions, the identity, is broken in OMPL 1.5.2: it assigns a vector of
	// another size to the projection, and the program aborts.
	if ( !space->hasDefaultProjection() || space->getDimension() <= 2 )
	{
		space->registerDefaultProjection( std::make_shared<PlaneProjection>( space.get() ) );
	}
}

} // namespace leeway::planners
