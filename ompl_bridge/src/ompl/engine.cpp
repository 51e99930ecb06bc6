// SPDX-License-Identifier: BSD-3-Clause
// The pool of queries: a list of slots that only ever grows, each taken and given back by one atomic exchange.
#include "slot.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <new>
#include <sstream>
#include <stdexcept>

namespace leeway::ompl
{

namespace
{

// Engines are numbered, not recognised by address: a new engine may be built where an old one was, and a thread that
// remembers a slot of the old one must not take it for the new one's.
std::atomic<std::uint64_t> next_engine_id{ 1 };

void requireOption( bool condition, const char* what )
{
	// written as "condition holds" so that a NaN is refused
	if ( !condition )
	{
		throw std::invalid_argument( std::string( "leeway::ompl::Options: " ) + what );
	}
}

Options checkedOptions( const Options& options )
{
	requireOption( options.min_d >= 0 && std::isfinite( options.min_d ), "min_d must be finite and at least 0" );
	requireOption( options.max_d > options.min_d, "max_d must be above min_d" );
	requireOption( options.alpha >= 0 && options.alpha < 1, "alpha must be in [0, 1)" );
	requireOption( options.slack > 0 && std::isfinite( options.slack ), "slack must be finite and above 0" );
	requireOption( options.step > 0 && std::isfinite( options.step ), "step must be finite and above 0" );
	requireOption( options.method == LW_EDGE_CERTIFIED || options.method == LW_EDGE_STEPS, "unknown edge method" );
	requireOption( options.flags >= LW_CHECK_ENVIRONMENT && options.flags <= LW_CHECK_BOTH, "unknown choice of clearances" );
	requireOption(
	    options.tolerance.empty() || options.method == LW_EDGE_CERTIFIED, "tolerance needs the method CERTIFIED" );
	return options;
}

/// The core refuses a tolerance that is wrong with each motion, and a motion that is refused is not valid.
void checkTolerance( const std::vector<double>& tolerance, const lw_checker* checker )
{
	if ( tolerance.empty() )
	{
		return;
	}
	requireOption(
	    tolerance.size() == lw_checker_variable_count( checker ), "tolerance must have a number for each variable" );
	const lw_robot* robot = lw_checker_robot( checker );
	for ( std::uint32_t i = 0; i < tolerance.size(); ++i )
	{
		const lw_variable_info info = lw_robot_variable( robot, lw_checker_variable( checker, i ) );
		const bool quaternion = lw_robot_joint_type( robot, info.joint ) == LW_JOINT_FLOATING && info.component >= 3;
		requireOption( tolerance[i] >= 0 && std::isfinite( tolerance[i] ), "tolerance must be finite and at least 0" );
		requireOption( !quaternion || tolerance[i] == 0, "tolerance of quaternions must be 0" );
	}
}

Checker checkedChecker( Checker checker )
{
	if ( !checker )
	{
		throw std::invalid_argument( "leeway::ompl::Engine: no checker" );
	}
	return checker;
}

/// Both checkers must accept the same state vectors.
void requireSameStates( const lw_checker* now, const lw_checker* next )
{
	const auto refuse = []( const std::string& what )
	{
		throw std::invalid_argument(
		    "leeway::ompl::Engine::update: " + what + "; make an engine for the other group or robot" );
	};
	const std::uint32_t count = lw_checker_variable_count( now );
	if ( lw_checker_variable_count( next ) != count )
	{
		refuse( "the state vector has " + std::to_string( lw_checker_variable_count( next ) ) + " entries instead of " +
		        std::to_string( count ) );
	}
	for ( std::uint32_t i = 0; i < count; ++i )
	{
		const lw_variable_info x = lw_robot_variable( lw_checker_robot( now ), lw_checker_variable( now, i ) );
		const lw_variable_info y = lw_robot_variable( lw_checker_robot( next ), lw_checker_variable( next, i ) );
		const std::string name = lw_robot_joint_name( lw_checker_robot( now ), x.joint );
		const std::string other = lw_robot_joint_name( lw_checker_robot( next ), y.joint );
		if ( name != other || x.component != y.component )
		{
			refuse( "entry " + std::to_string( i ) + " of the state vector is joint " + other + " instead of " + name );
		}
		if ( x.lower != y.lower || x.upper != y.upper || x.wraps != y.wraps )
		{
			refuse( "joint " + name + " has other limits" );
		}
	}
}

} // namespace

Engine::Engine( const ::ompl::base::StateSpacePtr& space, Checker checker, const Options& options )
    : m_checker( checkedChecker( std::move( checker ) ) ), m_options( checkedOptions( options ) ),
      m_adapter( space, m_checker ), m_id( next_engine_id.fetch_add( 1, std::memory_order_relaxed ) )
{
	checkTolerance( m_options.tolerance, m_checker.get() );
	// the first slot is made here, so that a machine without memory for even one says so at once
	Slot* slot = makeSlot();
	if ( slot == nullptr )
	{
		throw CoreError( LW_ERROR_OUT_OF_MEMORY, "leeway::ompl::Engine: no memory for a query" );
	}
	slot->busy.store( false, std::memory_order_release );
}

Engine::~Engine()
{
	for ( Slot* slot = m_slots.load( std::memory_order_acquire ); slot != nullptr; )
	{
		Slot* next = slot->next;
		delete slot;
		slot = next;
	}
}

Checker Engine::checker() const
{
	const std::lock_guard<std::mutex> lock( m_mutex );
	return m_checker;
}

void Engine::update( Checker checker )
{
	checker = checkedChecker( std::move( checker ) );
	requireSameStates( this->checker().get(), checker.get() );
	const std::lock_guard<std::mutex> lock( m_mutex );
	std::swap( m_checker, checker ); // the old one is released when the lock is
	m_undecided_count = 0;
	m_version.fetch_add( 1, std::memory_order_release );
}

Query Engine::makeQuery( const lw_checker* checker ) const
{
	lw_query_def def = lw_query_def_default();
	if ( m_version.load( std::memory_order_relaxed ) > 1 ) // a world that changes: room for a little more of it
	{
		def.spare_shapes = 8;
		def.spare_bodies = 2;
	}
	lw_query* query = nullptr;
	lw_status status = lw_query_create( &def, nullptr, checker, nullptr, &query );
	if ( status != LW_OK && def.spare_shapes > 0 )
	{
		def.spare_shapes = def.spare_bodies = 0;
		status = lw_query_create( &def, nullptr, checker, nullptr, &query );
	}
	return Query( status == LW_OK ? query : nullptr );
}

bool Engine::refresh( Slot& slot ) const
{
	Checker next;
	std::uint64_t version;
	{
		const std::lock_guard<std::mutex> lock( m_mutex );
		next = m_checker;
		version = m_version.load( std::memory_order_relaxed );
	}
	if ( !lw_query_fits( slot.query.get(), next.get() ) )
	{
		Query query = makeQuery( next.get() );
		if ( !query )
		{
			return false;
		}
		slot.query = std::move( query );
	}
	slot.checker = std::move( next );
	slot.version = version;
	return true;
}

Engine::Slot* Engine::makeSlot() const
{
	std::unique_ptr<Slot> slot( new ( std::nothrow ) Slot );
	if ( !slot )
	{
		return nullptr;
	}
	const std::size_t size = m_adapter.size();
	slot->memory.reset( new ( std::nothrow ) double[6 * size]() );
	if ( !slot->memory || !refresh( *slot ) )
	{
		return nullptr;
	}
	double* memory = slot->memory.get();
	for ( double** vector : { &slot->a, &slot->b, &slot->from, &slot->to, &slot->varied, &slot->result } )
	{
		*vector = memory;
		memory += size;
	}

	// Push: nothing is ever taken off the list, so there is no ABA problem and readers may walk it at any time.
	slot->next = m_slots.load( std::memory_order_relaxed );
	while ( !m_slots.compare_exchange_weak( slot->next, slot.get(), std::memory_order_release, std::memory_order_relaxed ) )
	{
	}
	return slot.release();
}

Engine::Slot* Engine::acquire() const
{
	// The slot that this thread used last is tried first: its warm starts are those of the thread's own path.
	struct Last
	{
		std::uint64_t engine = 0;
		Slot* slot = nullptr;
	};
	thread_local Last last;

	// the plain load keeps threads that walk past a busy slot from taking its cache line away from the owner
	auto take = []( Slot* slot )
	{ return !slot->busy.load( std::memory_order_relaxed ) && !slot->busy.exchange( true, std::memory_order_acquire ); };

	auto current = [this]( Slot* slot ) -> Slot*
	{
		if ( slot->version == m_version.load( std::memory_order_acquire ) || refresh( *slot ) )
		{
			return slot;
		}
		slot->busy.store( false, std::memory_order_release );
		return nullptr;
	};
	if ( last.engine == m_id && take( last.slot ) )
	{
		return current( last.slot );
	}
	for ( Slot* slot = m_slots.load( std::memory_order_acquire ); slot != nullptr; slot = slot->next )
	{
		if ( take( slot ) )
		{
			last = { m_id, slot };
			return current( slot );
		}
	}
	Slot* slot = makeSlot();
	if ( slot != nullptr )
	{
		last = { m_id, slot };
	}
	return slot;
}

Counters Engine::counters() const
{
	Counters total;
	for ( const Slot* slot = m_slots.load( std::memory_order_acquire ); slot != nullptr; slot = slot->next )
	{
		total.states += slot->states.value();
		total.edges += slot->edges.value();
		total.free += slot->free.value();
		total.blocked += slot->blocked.value();
		total.undecided += slot->undecided.value();
		total.edge_queries += slot->edge_queries.value();
		total.motion_costs += slot->motion_costs.value();
		total.cost_edges += slot->cost_edges.value();
		total.cost_queries += slot->cost_queries.value();
	}
	return total;
}

void Engine::noteUndecided( bool self, const lw_clearance& pair ) const
{
	const bool named = pair.kind != LW_CLEARANCE_UNKNOWN;
	addUndecided( self, named ? pair.a : LW_INVALID_INDEX, named ? pair.b : LW_INVALID_INDEX, 1, pair.upper );
}

void Engine::addUndecided( bool self, std::uint32_t a, std::uint32_t b, std::uint64_t times, double clearance ) const
{
	const std::lock_guard<std::mutex> lock( m_mutex );
	const auto end = m_undecided.begin() + static_cast<std::ptrdiff_t>( m_undecided_count );
	const auto found = std::find_if(
	    m_undecided.begin(), end, [=]( const UndecidedIds& p ) { return p.self == self && p.a == a && p.b == b; } );
	if ( found != end )
	{
		found->count += times;
		found->clearance = std::min( found->clearance, clearance );
	}
	else if ( m_undecided_count < m_undecided.size() )
	{
		m_undecided[m_undecided_count++] = { self, a, b, times, clearance };
	}
}

std::vector<UndecidedPair> Engine::undecidedPairs() const
{
	std::vector<UndecidedPair> undecided_pairs;
	const std::lock_guard<std::mutex> lock( m_mutex );
	const lw_robot* robot = lw_checker_robot( m_checker.get() );
	for ( std::size_t i = 0; i < m_undecided_count; ++i )
	{
		const UndecidedIds& pair = m_undecided[i];
		UndecidedPair undecided_pair{ pair.count, pair.self, "", "", pair.clearance };
		if ( pair.a != LW_INVALID_INDEX )
		{
			// of a snapshot that was replaced while the motion was judged an object may be no more
			const char* link = lw_robot_link_name( robot, pair.a );
			const char* other = pair.self ? lw_robot_link_name( robot, pair.b )
			                              : lw_scene_object_name( lw_checker_scene( m_checker.get() ), pair.b );
			undecided_pair.first = link != nullptr ? link : "?";
			undecided_pair.second = other != nullptr ? other : "?";
		}
		undecided_pairs.push_back( std::move( undecided_pair ) );
	}
	std::stable_sort( undecided_pairs.begin(), undecided_pairs.end(),
	    []( const UndecidedPair& x, const UndecidedPair& y ) { return x.count > y.count; } );
	return undecided_pairs;
}

std::string Engine::describeUndecided() const
{
	const std::vector<UndecidedPair> all = undecidedPairs();
	if ( all.empty() )
	{
		return "";
	}
	const Counters total = counters();
	const UndecidedPair& most = all.front();
	std::ostringstream text;
	text << total.undecided << " of " << total.edges
	     << " motions were undecided, neither proved free nor found to collide: ";
	if ( most.first.empty() )
	{
		text << most.count << " are so long that they would take more than " << LW_EDGE_MOST_STATES
		     << " states (narrow the joints' limits)";
		return text.str();
	}
	text << most.count << ( all.size() > 1 ? " of them" : "" ) << " for " << most.first << " - " << most.second
	     << ", which come within " << most.clearance << " m of each other (";
	if ( m_options.min_d > 0 )
	{
		text << "min_d is " << m_options.min_d << " m: lower it; ";
	}
	text << ( most.self ? "disable the pair in the SRDF if it may touch: leeway pairs shows which"
	                    : "allow the contact if it is meant" )
	     << ")";
	return text.str();
}

std::size_t Engine::queryCount() const
{
	std::size_t count = 0;
	for ( const Slot* slot = m_slots.load( std::memory_order_acquire ); slot != nullptr; slot = slot->next )
	{
		++count;
	}
	return count;
}

Engine::Lease::~Lease()
{
	if ( m_slot != nullptr )
	{
		m_slot->busy.store( false, std::memory_order_release );
	}
}

void Engine::Lease::count( const Counters& work ) const
{
	m_slot->states.add( work.states );
	m_slot->edges.add( work.edges );
	m_slot->free.add( work.free );
	m_slot->blocked.add( work.blocked );
	m_slot->undecided.add( work.undecided );
	m_slot->edge_queries.add( work.edge_queries );
}

void Engine::Lease::countUndecided(
    bool self, std::uint32_t a, std::uint32_t b, std::uint64_t times, double clearance ) const
{
	m_engine.addUndecided( self, a, b, times, clearance );
}

lw_query* Engine::Lease::query() const
{
	return m_slot != nullptr ? m_slot->query.get() : nullptr;
}

const lw_checker* Engine::Lease::checker() const
{
	return m_slot != nullptr ? m_slot->checker.get() : nullptr;
}

double* Engine::Lease::a() const
{
	return m_slot != nullptr ? m_slot->a : nullptr;
}

double* Engine::Lease::b() const
{
	return m_slot != nullptr ? m_slot->b : nullptr;
}

} // namespace leeway::ompl
