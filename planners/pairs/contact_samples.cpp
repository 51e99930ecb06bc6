// SPDX-License-Identifier: BSD-3-Clause
// Random states of a robot, and the distances of its pairs of links in them.
//
// Uniform random rotations: K. Shoemake, "Uniform random rotations", Graphics Gems III, 1992.
#include "leeway/pairs/contact_samples.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <iterator>
#include <limits>
#include <map>
#include <mutex>
#include <system_error>
#include <thread>

namespace leeway::pairs
{
namespace
{

/// Metres or radians to either side of the default value, where a joint has no limit.
constexpr double window = 1;
/// States in which distances of near pairs are measured: exact distances of fine meshes cost far more than contact.
constexpr std::uint32_t most_near_states = 300;
/// No state was found yet.
constexpr std::uint64_t no_state = UINT64_MAX;
/// States of one piece of work of seekContacts(): a pair found in contact is left out of the next.
constexpr std::uint64_t seek_piece = 2000;

/// State `index` of a sequence of random states. Each has a generator of its own, so that any thread can make any state.
class RandomStates
{
public:
	RandomStates( const lw_robot* robot, std::uint64_t seed ) : m_robot( robot ), m_seed( seed )
	{
		m_default.resize( lw_robot_variable_count( robot ) );
		lw_robot_default_state( robot, m_default.data() );
	}

	std::vector<double> state( std::uint64_t index ) const
	{
		std::seed_seq seeds = { m_seed & 0xffffffffu, m_seed >> 32, index & 0xffffffffu, index >> 32 };
		std::mt19937_64 random( seeds );
		std::vector<double> q = m_default;
		for ( std::uint32_t v = 0; v < q.size(); ++v )
		{
			const lw_variable_info info = lw_robot_variable( m_robot, v );
			const bool quaternion = lw_robot_joint_type( m_robot, info.joint ) == LW_JOINT_FLOATING && info.component >= 3;
			if ( !quaternion )
			{
				const double low = std::isfinite( info.lower ) ? info.lower : std::min( q[v], info.upper ) - window;
				const double high = std::isfinite( info.upper ) ? info.upper : std::max( q[v], info.lower ) + window;
				q[v] = low + uniform( random ) * ( high - low );
			}
			else if ( info.component == 3 )
			{
				rotation( random, &q[v] );
			}
		}
		return q;
	}

private:
	static double uniform( std::mt19937_64& random ) { return static_cast<double>( random() >> 11 ) * 0x1p-53; }

	static void rotation( std::mt19937_64& random, double* q )
	{
		const double turn = 6.283185307179586, u = uniform( random );
		const double a = turn * uniform( random ), b = turn * uniform( random );
		q[0] = std::sqrt( 1 - u ) * std::sin( a );
		q[1] = std::sqrt( 1 - u ) * std::cos( a );
		q[2] = std::sqrt( u ) * std::sin( b );
		q[3] = std::sqrt( u ) * std::cos( b );
	}

	const lw_robot* m_robot;
	std::uint64_t m_seed;
	std::vector<double> m_default;
};

/// Calls work( i ) for i < count on all cores; `make` makes a worker per thread. An exception of any is thrown again.
/// @param progress of the stage; may be empty
template <typename Make>
void onAllCores( std::uint64_t count, const motions::ProgressFunction& progress, const char* stage, const Make& make )
{
	std::atomic<std::uint64_t> next{ 0 };
	std::uint64_t done = 0; // with `mutex`
	std::exception_ptr failure;
	std::mutex mutex;
	const auto run = [&]
	{
		try
		{
			auto work = make();
			for ( std::uint64_t i = next++; i < count; i = next++ )
			{
				work( i );
				if ( progress )
				{
					const std::lock_guard<std::mutex> lock( mutex );
					progress( stage, double( ++done ) / double( count ) );
				}
			}
		}
		catch ( ... )
		{
			const std::lock_guard<std::mutex> lock( mutex );
			failure = std::current_exception();
			next = count;
		}
	};
	std::vector<std::thread> threads;
	try
	{
		for ( std::uint64_t i = 1; i < std::min<std::uint64_t>( count, std::thread::hardware_concurrency() ); ++i )
		{
			threads.emplace_back( run );
		}
	}
	catch ( const std::system_error& )
	{
		// the system gives no more threads: those that run do the work
	}
	run();
	for ( std::thread& thread : threads )
	{
		thread.join();
	}
	if ( failure )
	{
		std::rethrow_exception( failure );
	}
}

/// Contact counts only where nothing proves that there is none.
bool mayTouch( const PairRow& row )
{
	return row.pair.kind != LW_PAIR_RIGID && !( row.pair.separation > 0 );
}

} // namespace

ContactSamples::ContactSamples( const Robot& robot, PairTable& table, const SampleOptions& options )
    : m_robot( robot ), m_seed( options.seed ), m_states( options.states )
{
	if ( m_states > 0 )
	{
		countContacts( table, options );
		measureNear( table, options );
	}
	if ( options.never_after > 0 )
	{
		seekContacts( table, options );
	}
}

void ContactSamples::countContacts( PairTable& table, const SampleOptions& options )
{
	const RandomStates random( m_robot.get(), m_seed );
	m_contacts.resize( m_states );
	onAllCores( m_states, options.progress, "contacts in random states",
	    [&]
	    {
		    return [&, links = LinkDistances( m_robot )]( std::uint64_t i ) mutable
		    {
			    links.move( random.state( i ) );
			    for ( std::uint32_t row = 0; row < table.rows().size(); ++row )
			    {
				    const PairRow& pair = table.rows()[row];
				    if ( mayTouch( pair ) && links.measure( pair.link_a, pair.link_b, contact_range ).upper <= 0 )
				    {
					    m_contacts[i].push_back( row );
				    }
			    }
		    };
	    } );
	std::vector<std::uint32_t> counts( table.rows().size() ), first( table.rows().size() );
	for ( std::uint32_t i = m_states; i-- > 0; )
	{
		for ( const std::uint32_t row : m_contacts[i] )
		{
			++counts[row];
			first[row] = i;
		}
	}
	for ( std::size_t row = 0; row < counts.size(); ++row )
	{
		if ( mayTouch( table.rows()[row] ) )
		{
			table.setContacts(
			    row, counts[row], m_states, counts[row] > 0 ? random.state( first[row] ) : std::vector<double>() );
		}
	}
}

/// Pairs that came near are looked at state by state; a pair that is far in more than a few states is dropped.
void ContactSamples::measureNear( const PairTable& table, const SampleOptions& options )
{
	const std::uint32_t states = std::min( m_states, most_near_states );
	const RandomStates random( m_robot.get(), m_seed );
	std::vector<std::size_t> candidates;
	for ( std::size_t i = 0; i < table.rows().size(); ++i )
	{
		const lw_reach_pair& pair = table.rows()[i].pair;
		const bool moves = pair.kind != LW_PAIR_RIGID && !pair.adjacent;
		if ( moves && pair.closest > 0 && pair.closest < near_distance )
		{
			candidates.push_back( i );
		}
	}
	std::vector<NearRange> ranges( candidates.size() );
	onAllCores( candidates.size(), options.progress, "distances of links that come near",
	    [&]
	    {
		    return [&, links = LinkDistances( m_robot )]( std::uint64_t i ) mutable
		    {
			    const PairRow& row = table.rows()[candidates[i]];
			    std::uint32_t far = 0;
			    for ( std::uint32_t k = 0; k < states && far <= ( 1 - nearly_all ) * states; ++k )
			    {
				    links.move( random.state( k ) );
				    far += links.measure( row.link_a, row.link_b, near_distance ).upper < near_distance ? 0 : 1;
			    }
			    if ( far > ( 1 - nearly_all ) * states )
			    {
				    return;
			    }
			    ranges[i] = { candidates[i], std::numeric_limits<double>::infinity(), 0, states };
			    for ( std::uint32_t k = 0; k < states; ++k )
			    {
				    links.move( random.state( k ) );
				    const double distance =
				        links.measure( row.link_a, row.link_b, std::numeric_limits<double>::infinity() ).upper;
				    ranges[i].least = std::min( ranges[i].least, distance );
				    ranges[i].most = std::max( ranges[i].most, distance );
			    }
		    };
	    } );
	std::copy_if( ranges.begin(), ranges.end(), std::back_inserter( m_near ),
	    []( const NearRange& range ) { return range.states > 0; } );
}

void ContactSamples::seekContacts( PairTable& table, const SampleOptions& options )
{
	const std::uint64_t count = options.never_after;
	const RandomStates random( m_robot.get(), m_seed );
	std::vector<std::size_t> open;
	for ( std::size_t i = 0; i < table.rows().size(); ++i )
	{
		const PairRow& row = table.rows()[i];
		if ( mayTouch( row ) && !row.pair.adjacent && row.pair.closest > 0 )
		{
			open.push_back( i );
		}
	}
	// The first states are those that countContacts() has looked at.
	for ( std::uint64_t begin = m_states; begin < count && !open.empty(); begin += seek_piece )
	{
		std::vector<std::atomic<std::uint64_t>> found( open.size() );
		std::fill( found.begin(), found.end(), no_state );
		onAllCores( std::min( seek_piece, count - begin ), {}, "",
		    [&]
		    {
			    return [&, links = LinkDistances( m_robot )]( std::uint64_t i ) mutable
			    {
				    links.move( random.state( begin + i ) );
				    for ( std::size_t k = 0; k < open.size(); ++k )
				    {
					    const PairRow& row = table.rows()[open[k]];
					    std::uint64_t known = found[k].load();
					    if ( begin + i < known && links.measure( row.link_a, row.link_b, contact_range ).upper <= 0 )
					    {
						    while ( begin + i < known && !found[k].compare_exchange_weak( known, begin + i ) )
						    {
						    }
					    }
				    }
			    };
		    } );
		std::vector<std::size_t> left;
		for ( std::size_t k = 0; k < open.size(); ++k )
		{
			if ( found[k] == no_state )
			{
				left.push_back( open[k] );
				continue;
			}
			table.setContactState( open[k], random.state( found[k] ) );
		}
		open = left;
		motions::report( options.progress, "seeking contact of pairs that are not proved apart",
		    std::min( 1.0, double( begin + seek_piece ) / double( count ) ) );
	}
	for ( const std::size_t row : open )
	{
		table.setNeverSeen( row, std::max<std::uint64_t>( count, m_states ) );
	}
}

std::size_t ContactSamples::freeStates( const std::function<bool( std::size_t )>& checked ) const
{
	return static_cast<std::size_t>( std::count_if( m_contacts.begin(), m_contacts.end(),
	    [&]( const Contacts& rows ) { return std::none_of( rows.begin(), rows.end(), checked ); } ) );
}

std::vector<ContactSamples::Blocking> ContactSamples::blocking( const std::function<bool( std::size_t )>& checked ) const
{
	std::map<std::uint32_t, Blocking> pairs;
	for ( const Contacts& rows : m_contacts )
	{
		Contacts counted;
		std::copy_if( rows.begin(), rows.end(), std::back_inserter( counted ), checked );
		for ( const std::uint32_t row : counted )
		{
			Blocking& pair = pairs[row];
			pair.row = row;
			++pair.states;
			pair.alone += counted.size() == 1 ? 1 : 0;
		}
	}
	std::vector<Blocking> result;
	for ( const auto& entry : pairs )
	{
		result.push_back( entry.second );
	}
	std::stable_sort(
	    result.begin(), result.end(), []( const Blocking& x, const Blocking& y ) { return x.states > y.states; } );
	return result;
}

} // namespace leeway::pairs
