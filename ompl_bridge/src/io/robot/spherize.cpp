// SPDX-License-Identifier: BSD-3-Clause
// Spheres of a robot's links: one excess for all links. Given a number of spheres instead, a search finds that excess.
#include "leeway/io/spheres.hpp"
#include "leeway/parallel.hpp"

#include "base/io_internal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <iterator>
#include <mutex>
#include <thread>

namespace leeway::io
{

namespace
{

using Clock = std::chrono::steady_clock;

constexpr std::uint32_t decimals = 6; ///< of the numbers in the files
constexpr double least_excess = 1e-5;
constexpr int max_steps = 12;         ///< of the search by number
constexpr double close_enough = 1.03; ///< the ratio of excesses between which it ends

struct SpheresDeleter
{
	void operator()( lw_spheres* spheres ) const { lw_spheres_destroy( spheres ); }
};

/// A link's shapes in the form of lw_geometry_def.
struct Geometry
{
	std::string link;
	std::vector<const lw_shape*> shapes;
	std::vector<lw_transform> poses;
	double close_holes = 0;

	lw_geometry_def def() const
	{
		return { shapes.data(), poses.data(), static_cast<std::uint32_t>( shapes.size() ), close_holes };
	}
};

std::vector<Geometry> geometryOf( const RobotModel& model, double close_holes )
{
	std::vector<Geometry> out;
	for ( const LinkModel& link : model.links )
	{
		Geometry g{ link.name, {}, {}, close_holes };
		for ( const PlacedShape& placed : link.collision )
		{
			g.shapes.push_back( placed.shape.get() );
			g.poses.push_back( placed.pose );
		}
		if ( !g.shapes.empty() )
		{
			out.push_back( std::move( g ) );
		}
	}
	return out;
}

/// End of a search: at a time, or once the flag is set.
struct Stop
{
	Clock::time_point at = Clock::time_point::max();
	const std::atomic<bool>* now = nullptr;

	static bool asked( void* user )
	{
		const Stop& stop = *static_cast<const Stop*>( user );
		return ( stop.now != nullptr && *stop.now ) || ( stop.at != Clock::time_point::max() && Clock::now() >= stop.at );
	}
};

LinkSpheres enclose( const RobotModel& model, const Geometry& geometry, double excess, Stop* stop )
{
	const detail::Stopwatch watch;
	lw_spheres_def def = lw_spheres_def_default();
	def.body = geometry.def();
	def.excess = excess;
	def.decimals = decimals;
	def.stop = stop != nullptr ? Stop::asked : nullptr;
	def.user = stop;
	lw_spheres* made = nullptr;
	lw_diag diag{};
	const lw_status status = lw_spheres_create( &def, nullptr, &diag, &made );
	const std::unique_ptr<lw_spheres, SpheresDeleter> owner( made );
	if ( status == LW_ERROR_UNSUPPORTED )
	{
		throw Error( model.urdf_file, "link " + geometry.link, diag.message, "allow a larger excess, or fewer spheres" );
	}
	require( status, diag );
	LinkSpheres out;
	out.link = geometry.link;
	const double* data = lw_spheres_data( made );
	out.spheres.assign( data, data + 4 * static_cast<std::size_t>( lw_spheres_count( made ) ) );
	out.report = lw_spheres_get_report( made );
	out.met_target = lw_spheres_met_target( made );
	out.milliseconds = watch.milliseconds();
	return out;
}

class Search
{
public:
	Search( const RobotModel& model, const SpherizeOptions& options )
	    : m_model( model ), m_options( options ), m_geometry( geometryOf( model, options.close_holes ) ),
	      m_threads( options.threads > 0 ? options.threads : std::max( 1u, std::thread::hardware_concurrency() ) )
	{
		if ( options.seconds > 0 )
		{
			m_end += std::chrono::duration_cast<Clock::duration>( std::chrono::duration<double>( options.seconds ) );
		}
		// Links with few triangles first: the unused part of their time goes to the others.
		std::vector<std::size_t> triangles;
		for ( const Geometry& g : m_geometry )
		{
			std::size_t sum = 0;
			for ( const lw_shape* shape : g.shapes )
			{
				sum += lw_shape_peek_info( shape ).triangle_count;
			}
			m_order.push_back( triangles.size() );
			triangles.push_back( sum );
		}
		std::stable_sort( m_order.begin(), m_order.end(),
		    [&triangles]( std::size_t a, std::size_t b ) { return triangles[a] < triangles[b]; } );
	}

	/// Spheres of each link with at most this excess, as far as the time reaches.
	std::vector<LinkSpheres> byExcess( double excess )
	{
		std::vector<LinkSpheres> out( m_geometry.size() );
		std::vector<char> late( m_geometry.size() ); // not bool: each thread writes its own
		std::atomic<std::size_t> done{ 0 };
		const bool limited = m_options.seconds > 0;
		inParallel( out.size(), m_threads,
		    [&]( std::size_t i )
		    {
			    const std::size_t link = m_order[i];
			    tell( m_geometry[link].link, static_cast<double>( done ) / static_cast<double>( out.size() ) );
			    Stop stop{ limited ? fairEnd( out.size() - i ) : Clock::time_point::max(), nullptr };
			    out[link] = enclose( m_model, m_geometry[link], excess, limited ? &stop : nullptr );
			    late[link] = !out[link].met_target && Clock::now() >= stop.at;
			    ++done;
		    } );
		// Links that ran out of time get a second, longer run in the time that the other links left over.
		std::vector<std::size_t> again;
		std::copy_if( m_order.begin(), m_order.end(), std::back_inserter( again ),
		    [&late]( std::size_t link ) { return late[link] != 0; } );
		inParallel( again.size(), m_threads,
		    [&]( std::size_t i )
		    {
			    tell( m_geometry[again[i]].link,
			        static_cast<double>( done - again.size() + i ) / static_cast<double>( out.size() ) );
			    Stop stop{ fairEnd( again.size() - i ), nullptr };
			    LinkSpheres better = enclose( m_model, m_geometry[again[i]], excess, &stop );
			    if ( better.report.excess < out[again[i]].report.excess )
			    {
				    better.milliseconds += out[again[i]].milliseconds;
				    out[again[i]] = std::move( better );
			    }
		    } );
		return out;
	}

	/// At most `most` spheres for all links together, of the least excess found that needs no more.
	std::vector<LinkSpheres> byCount( std::size_t most )
	{
		if ( most < m_geometry.size() )
		{
			throw Error( m_model.urdf_file, "spheres",
			    fmt::format( "{} spheres for {} links with geometry", most, m_geometry.size() ),
			    fmt::format( "give {} or more", m_geometry.size() ) );
		}
		std::vector<LinkSpheres> best = oneEach();
		double low = 0, high = 0;
		for ( const LinkSpheres& link : best )
		{
			high = std::max( high, link.report.excess );
		}
		bool ended = false;
		for ( int step = 0; step < max_steps && high > close_enough * low && high > least_excess && !ended; ++step )
		{
			const double middle = std::max( low > 0 ? std::sqrt( low * high ) : 0.4 * high, least_excess );
			std::vector<LinkSpheres> next;
			const bool few = atMost( most, middle, static_cast<double>( step ) / max_steps, next );
			ended = m_options.seconds > 0 && Clock::now() >= m_end;
			if ( few )
			{
				best = std::move( next );
			}
			( few ? high : low ) = middle;
		}
		for ( LinkSpheres& link : best )
		{
			link.met_target = !ended;
		}
		return best;
	}

private:
	void tell( const std::string& link, double share )
	{
		if ( m_options.progress )
		{
			const std::lock_guard<std::mutex> lock( m_mutex );
			m_options.progress( link, share );
		}
	}

	/// The end of one link's search if the others that wait are to have as much.
	Clock::time_point fairEnd( std::size_t waiting ) const
	{
		const Clock::time_point now = Clock::now();
		const double share = std::min( 1.0, static_cast<double>( m_threads ) / static_cast<double>( waiting ) );
		return now + std::chrono::duration_cast<Clock::duration>( share * ( m_end - now ) );
	}

	/// One sphere around each link.
	std::vector<LinkSpheres> oneEach()
	{
		std::vector<LinkSpheres> out( m_geometry.size() );
		const std::atomic<bool> now{ true };
		inParallel( out.size(), m_threads,
		    [&]( std::size_t i )
		    {
			    Stop stop{ Clock::time_point::max(), &now };
			    out[i] = enclose( m_model, m_geometry[i], least_excess, &stop );
		    } );
		return out;
	}

	/// @return whether spheres of this excess are at most so many; they are in `out` then
	bool atMost( std::size_t most, double excess, double share, std::vector<LinkSpheres>& out )
	{
		out.assign( m_geometry.size(), {} );
		std::atomic<std::size_t> sum{ m_geometry.size() }; // one for each that is not known yet
		std::atomic<bool> too_many{ false };
		inParallel( out.size(), m_threads,
		    [&]( std::size_t i )
		    {
			    const std::size_t link = m_order[i];
			    tell( m_geometry[link].link, share );
			    Stop stop{ m_options.seconds > 0 ? m_end : Clock::time_point::max(), &too_many };
			    if ( !too_many )
			    {
				    out[link] = enclose( m_model, m_geometry[link], excess, &stop );
				    sum += out[link].count() - 1;
				    too_many = too_many || sum > most || !out[link].met_target;
			    }
		    } );
		return !too_many;
	}

	const RobotModel& m_model;
	const SpherizeOptions& m_options;
	std::vector<Geometry> m_geometry;
	unsigned m_threads;
	Clock::time_point m_end = Clock::now();
	std::vector<std::size_t> m_order; ///< of m_geometry
	std::mutex m_mutex;               ///< of the options' progress
};

} // namespace

std::vector<LinkSpheres> spherize( const RobotModel& model, const SpherizeOptions& options )
{
	if ( options.excess > 0 && options.excess < least_excess )
	{
		throw Error( model.urdf_file, "excess",
		    fmt::format( "{} m is below the {} m that the files resolve", options.excess, least_excess ), "allow more" );
	}
	Search search( model, options );
	return options.excess > 0 ? search.byExcess( options.excess ) : search.byCount( options.sphere_count );
}

} // namespace leeway::io
