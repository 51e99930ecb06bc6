// SPDX-License-Identifier: BSD-3-Clause
// Counters of a run as post-run properties of OMPL's Benchmark.
#include "leeway/ompl/benchmark.hpp"

#include <stdexcept>

namespace leeway::ompl
{

namespace ot = ::ompl::tools;

namespace
{

struct Property
{
	const char* key;
	std::uint64_t Counters::*counter;
};

constexpr Property properties[] = {
    { "leeway states INTEGER", &Counters::states },
    { "leeway edges INTEGER", &Counters::edges },
    { "leeway edges free INTEGER", &Counters::free },
    { "leeway edges blocked INTEGER", &Counters::blocked },
    { "leeway edges undecided INTEGER", &Counters::undecided },
    { "leeway edge queries INTEGER", &Counters::edge_queries },
    { "leeway motion costs INTEGER", &Counters::motion_costs },
    { "leeway cost edges INTEGER", &Counters::cost_edges },
    { "leeway cost queries INTEGER", &Counters::cost_queries },
};

} // namespace

Counters difference( const Counters& later, const Counters& earlier )
{
	Counters result;
	for ( const Property& property : properties )
	{
		result.*property.counter = later.*property.counter - earlier.*property.counter;
	}
	return result;
}

std::map<std::string, std::string> runProperties( const Counters& counters )
{
	std::map<std::string, std::string> result;
	for ( const Property& property : properties )
	{
		result[property.key] = std::to_string( counters.*property.counter );
	}
	return result;
}

void addRunProperties( ot::Benchmark& benchmark, std::shared_ptr<const Engine> engine, ot::Benchmark::PreSetupEvent pre_run,
    ot::Benchmark::PostSetupEvent post_run )
{
	if ( !engine )
	{
		throw std::invalid_argument( "leeway::ompl::addRunProperties: no engine" );
	}
	auto before = std::make_shared<Counters>( engine->counters() );
	benchmark.setPreRunEvent(
	    [engine, before, pre_run = std::move( pre_run )]( const ::ompl::base::PlannerPtr& planner )
	    {
		    *before = engine->counters();
		    if ( pre_run )
		    {
			    pre_run( planner );
		    }
	    } );
	// RunProperties is a std::map up to OMPL 1.6 and derived from one later: use only members that both have
	benchmark.setPostRunEvent(
	    [engine = std::move( engine ), before, post_run = std::move( post_run )](
	        const ::ompl::base::PlannerPtr& planner, ot::Benchmark::RunProperties& run )
	    {
		    for ( const auto& property : runProperties( difference( engine->counters(), *before ) ) )
		    {
			    run[property.first] = property.second;
		    }
		    if ( post_run )
		    {
			    post_run( planner, run );
		    }
	    } );
}

} // namespace leeway::ompl
