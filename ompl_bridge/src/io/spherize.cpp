// SPDX-License-Identifier: BSD-3-Clause
// Spheres of a robot's links: one excess for all, found by the number of spheres where that is what is given.
#include "leeway/io/spheres.hpp"

#include "io_internal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace leeway::io
{

namespace
{

/// Written numbers have this grain, metres. A centre moves by at most sqrt(3)/2 of it and a radius grows by that and one
/// grain:
/// the excess by less than 3.
constexpr double grain = 1e-6;
constexpr double least_excess = 1e-5;
constexpr int max_steps = 12;         ///< of the search by number
constexpr double close_enough = 1.03; ///< the ratio of excesses between which it ends

struct SpheresDeleter
{
	void operator()( lw_spheres* spheres ) const { lw_spheres_destroy( spheres ); }
};

/// A link's shapes as the core wants them.
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

std::vector<double> enclose( const RobotModel& model, const Geometry& geometry, double excess )
{
	lw_spheres_def def = lw_spheres_def_default();
	def.body = geometry.def();
	def.excess = excess;
	lw_spheres* made = nullptr;
	lw_diag diag{};
	const lw_status status = lw_spheres_create( &def, nullptr, &diag, &made );
	const std::unique_ptr<lw_spheres, SpheresDeleter> owner( made );
	if ( status == LW_ERROR_UNSUPPORTED )
	{
		throw Error( model.urdf_file, "link " + geometry.link, diag.message, "allow a larger excess, or fewer spheres" );
	}
	require( status, diag );
	const double* data = lw_spheres_data( made );
	return { data, data + 4 * static_cast<std::size_t>( lw_spheres_count( made ) ) };
}

/// Centres to the nearest grain, radii up to the next one that makes up for it.
void roundOutward( std::vector<double>& spheres )
{
	for ( std::size_t i = 0; i < spheres.size(); i += 4 )
	{
		double moved_sq = 0;
		for ( std::size_t k = 0; k < 3; ++k )
		{
			const double rounded = std::round( spheres[i + k] / grain ) * grain;
			moved_sq += ( rounded - spheres[i + k] ) * ( rounded - spheres[i + k] );
			// the double that the six decimals read back as
			spheres[i + k] = *detail::parseNumber( fmt::format( "{:.6f}", rounded ) );
		}
		const double radius = std::ceil( ( spheres[i + 3] + std::sqrt( moved_sq ) ) / grain * ( 1 + 1e-9 ) ) * grain;
		spheres[i + 3] = *detail::parseNumber( fmt::format( "{:.6f}", radius ) );
	}
}

class Search
{
public:
	Search( const RobotModel& model, const SpherizeOptions& options )
	    : m_model( model ), m_options( options ), m_geometry( geometryOf( model, options.close_holes ) )
	{
	}
	const std::vector<Geometry>& geometry() const { return m_geometry; }

	/// Spheres of all links together, or more than `most` as soon as that is certain.
	std::size_t count( double excess, std::size_t most, double share ) const
	{
		std::size_t sum = 0;
		for ( std::size_t i = 0; i < m_geometry.size() && sum + ( m_geometry.size() - i ) <= most; ++i )
		{
			tell( m_geometry[i].link, share );
			sum += enclose( m_model, m_geometry[i], excess ).size() / 4;
			if ( sum + ( m_geometry.size() - i - 1 ) > most )
			{
				return most + 1;
			}
		}
		return sum;
	}

	/// The least excess found for which the links together take at most so many spheres.
	double excessFor( std::size_t most ) const
	{
		if ( most < m_geometry.size() )
		{
			throw Error( m_model.urdf_file, "spheres",
			    fmt::format( "{} spheres for {} links with geometry", most, m_geometry.size() ),
			    fmt::format( "give {} or more", m_geometry.size() ) );
		}
		double low = 0, high = 0;
		for ( const Geometry& g : m_geometry )
		{
			double size = 0;
			for ( std::size_t i = 0; i < g.shapes.size(); ++i )
			{
				const lw_shape_info info = lw_shape_get_info( g.shapes[i] );
				const lw_vec3 c = lw_transform_point(
				    &g.poses[i], { info.sphere_center[0], info.sphere_center[1], info.sphere_center[2] } );
				size = std::max( size, std::hypot( c.x, c.y, c.z ) + info.sphere_radius );
			}
			high = std::max( high, 4 * size ); // one sphere about each link needs less
		}
		for ( int step = 0; step < max_steps && high > close_enough * low; ++step )
		{
			const double middle = low > 0 ? std::sqrt( low * high ) : 0.5 * high;
			( count( middle, most, 0.8 * step / max_steps ) <= most ? high : low ) = middle;
			if ( high < least_excess )
			{
				break;
			}
		}
		return high;
	}

	LinkSpheres make( std::size_t index, double excess, double share ) const
	{
		const Geometry& geometry = m_geometry[index];
		tell( geometry.link, share );
		const detail::Stopwatch watch;
		LinkSpheres out;
		out.link = geometry.link;
		out.spheres = enclose( m_model, geometry, excess );
		roundOutward( out.spheres );
		lw_diag diag{};
		const lw_geometry_def def = geometry.def();
		require( lw_spheres_check( &def, out.spheres.data(), static_cast<std::uint32_t>( out.count() ), nullptr, &diag,
		             &out.report ),
		    diag );
		if ( !out.report.encloses )
		{
			throw Error( m_model.urdf_file, "link " + geometry.link,
			    "the spheres with rounded numbers could not be proved to enclose it", "use another excess" );
		}
		out.milliseconds = watch.milliseconds();
		return out;
	}

private:
	void tell( const std::string& link, double share ) const
	{
		if ( m_options.progress )
		{
			m_options.progress( link, share );
		}
	}
	const RobotModel& m_model;
	const SpherizeOptions& m_options;
	std::vector<Geometry> m_geometry;
};

} // namespace

std::vector<LinkSpheres> spherize( const RobotModel& model, const SpherizeOptions& options )
{
	const Search search( model, options );
	double excess = options.excess;
	if ( excess > 0 && excess < least_excess )
	{
		throw Error( model.urdf_file, "excess", fmt::format( "{} m is below the {} m that the files resolve", excess,
		    least_excess ),
		    "allow more" );
	}
	// room for the grain of what is written
	excess = excess > 0 ? excess - 3 * grain : search.excessFor( options.sphere_count );
	std::vector<LinkSpheres> out;
	const std::size_t links = search.geometry().size();
	for ( std::size_t i = 0; i < links; ++i )
	{
		const double done = static_cast<double>( i ) / static_cast<double>( links );
		out.push_back( search.make( i, excess, options.excess > 0 ? done : 0.8 + 0.2 * done ) );
	}
	return out;
}

} // namespace leeway::io
