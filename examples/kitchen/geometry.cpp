// SPDX-License-Identifier: BSD-3-Clause
// Mesh builders: lofts of superellipses, lathed profiles, rounded boxes and pipes; STL and OBJ bytes.
#include "geometry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace kitchen
{

Vec3 cross( Vec3 a, Vec3 b )
{
	return { a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}

double length( Vec3 a )
{
	return std::sqrt( dot( a, a ) );
}

Vec3 normalised( Vec3 a )
{
	const double l = length( a );
	return l > 0 ? ( 1 / l ) * a : a;
}

Pose turned( Vec3 u, double angle )
{
	const double c = std::cos( angle ), s = std::sin( angle ), k = 1 - c;
	Pose pose;
	const double r[3][3] = { { c + u.x * u.x * k, u.x * u.y * k - u.z * s, u.x * u.z * k + u.y * s },
	    { u.y * u.x * k + u.z * s, c + u.y * u.y * k, u.y * u.z * k - u.x * s },
	    { u.z * u.x * k - u.y * s, u.z * u.y * k + u.x * s, c + u.z * u.z * k } };
	std::memcpy( pose.r, r, sizeof r );
	return pose;
}

Pose at( double x, double y, double z, double roll, double pitch, double yaw )
{
	Pose pose = turned( { 0, 0, 1 }, yaw ) * turned( { 0, 1, 0 }, pitch ) * turned( { 1, 0, 0 }, roll );
	pose.t = { x, y, z };
	return pose;
}

Pose operator*( const Pose& a, const Pose& b )
{
	Pose c;
	for ( int i = 0; i < 3; ++i )
		for ( int j = 0; j < 3; ++j )
			c.r[i][j] = a.r[i][0] * b.r[0][j] + a.r[i][1] * b.r[1][j] + a.r[i][2] * b.r[2][j];
	c.t = a * b.t;
	return c;
}

Vec3 operator*( const Pose& a, Vec3 p )
{
	return { a.r[0][0] * p.x + a.r[0][1] * p.y + a.r[0][2] * p.z + a.t.x,
	    a.r[1][0] * p.x + a.r[1][1] * p.y + a.r[1][2] * p.z + a.t.y,
	    a.r[2][0] * p.x + a.r[2][1] * p.y + a.r[2][2] * p.z + a.t.z };
}

std::array<double, 4> quaternion( const Pose& pose )
{
	// the largest of the four squared components is the safe divisor
	const auto& r = pose.r;
	const double squares[4] = { 1 + r[0][0] - r[1][1] - r[2][2], 1 - r[0][0] + r[1][1] - r[2][2],
	    1 - r[0][0] - r[1][1] + r[2][2], 1 + r[0][0] + r[1][1] + r[2][2] };
	const int largest = static_cast<int>( std::max_element( squares, squares + 4 ) - squares );
	const double s = 0.5 / std::sqrt( squares[largest] ), big = 0.5 * std::sqrt( squares[largest] );
	std::array<double, 4> q;
	if ( largest == 3 )
		q = { ( r[2][1] - r[1][2] ) * s, ( r[0][2] - r[2][0] ) * s, ( r[1][0] - r[0][1] ) * s, big };
	else if ( largest == 0 )
		q = { big, ( r[0][1] + r[1][0] ) * s, ( r[0][2] + r[2][0] ) * s, ( r[2][1] - r[1][2] ) * s };
	else if ( largest == 1 )
		q = { ( r[0][1] + r[1][0] ) * s, big, ( r[1][2] + r[2][1] ) * s, ( r[0][2] - r[2][0] ) * s };
	else
		q = { ( r[0][2] + r[2][0] ) * s, ( r[1][2] + r[2][1] ) * s, big, ( r[1][0] - r[0][1] ) * s };
	if ( q[3] < 0 )
		for ( double& v : q )
			v = -v;
	return q;
}

Mesh& Mesh::add( const Mesh& other, const Pose& pose )
{
	const auto base = static_cast<uint32_t>( vertices.size() );
	for ( Vec3 v : other.vertices )
		vertices.push_back( pose * v );
	for ( auto t : other.triangles )
		triangles.push_back( { base + t[0], base + t[1], base + t[2] } );
	return *this;
}

Mesh Mesh::placed( const Pose& pose ) const
{
	return Mesh().add( *this, pose );
}

Mesh Mesh::mirroredY() const
{
	Mesh mesh = *this;
	for ( Vec3& v : mesh.vertices )
		v.y = -v.y;
	for ( auto& t : mesh.triangles )
		std::swap( t[1], t[2] );
	return mesh;
}

Mesh loft( const std::vector<Ring>& rings, int segments, bool caps )
{
	Mesh mesh;
	std::vector<uint32_t> first; // index of each ring's first vertex; poles have one vertex only
	auto isPole = []( const Ring& ring ) { return ring.rx <= 0 && ring.ry <= 0; };
	for ( const Ring& ring : rings )
	{
		first.push_back( static_cast<uint32_t>( mesh.vertices.size() ) );
		if ( isPole( ring ) )
		{
			mesh.vertices.push_back( { ring.cx, ring.cy, ring.z } );
			continue;
		}
		for ( int i = 0; i < segments; ++i )
		{
			const double c = std::cos( 2 * pi * i / segments ), s = std::sin( 2 * pi * i / segments );
			const double scale = std::pow(
			    std::pow( std::fabs( c ), ring.exponent ) + std::pow( std::fabs( s ), ring.exponent ), -1 / ring.exponent );
			mesh.vertices.push_back( { ring.cx + ring.rx * scale * c, ring.cy + ring.ry * scale * s, ring.z } );
		}
	}
	const auto n = static_cast<uint32_t>( segments );
	auto fan = [&]( uint32_t centre, uint32_t ring, bool up )
	{
		for ( uint32_t i = 0; i < n; ++i )
		{
			const uint32_t a = ring + i, b = ring + ( i + 1 ) % n;
			mesh.triangles.push_back(
			    up ? std::array<uint32_t, 3>{ centre, a, b } : std::array<uint32_t, 3>{ centre, b, a } );
		}
	};
	auto cap = [&]( size_t ring, bool up )
	{
		const Ring& end = rings[ring];
		mesh.vertices.push_back( { end.cx, end.cy, end.z } );
		fan( static_cast<uint32_t>( mesh.vertices.size() - 1 ), first[ring], up );
	};
	for ( size_t k = 0; k + 1 < rings.size(); ++k )
	{
		if ( isPole( rings[k] ) && isPole( rings[k + 1] ) )
			continue;
		if ( isPole( rings[k] ) )
			fan( first[k], first[k + 1], false );
		else if ( isPole( rings[k + 1] ) )
			fan( first[k + 1], first[k], true );
		else
			for ( uint32_t i = 0; i < n; ++i )
			{
				const uint32_t a = first[k] + i, b = first[k] + ( i + 1 ) % n;
				const uint32_t c = first[k + 1] + i, d = first[k + 1] + ( i + 1 ) % n;
				mesh.triangles.push_back( { a, b, d } );
				mesh.triangles.push_back( { a, d, c } );
			}
	}
	if ( caps && !isPole( rings.front() ) )
		cap( 0, false );
	if ( caps && !isPole( rings.back() ) )
		cap( rings.size() - 1, true );
	return mesh;
}

static double catmullRom( double a, double b, double c, double d, double t )
{
	return b + 0.5 * t * ( c - a + t * ( 2 * a - 5 * b + 4 * c - d + t * ( 3 * ( b - c ) + d - a ) ) );
}

std::vector<Ring> smoothed( const std::vector<Ring>& keys, int steps )
{
	std::vector<Ring> rings;
	for ( size_t k = 0; k + 1 < keys.size(); ++k )
	{
		const Ring &a = keys[k > 0 ? k - 1 : k], &b = keys[k], &c = keys[k + 1],
		           &d = keys[std::min( k + 2, keys.size() - 1 )];
		for ( int i = 0; i < steps; ++i )
		{
			const double t = static_cast<double>( i ) / steps;
			auto mix = [&]( double Ring::*m ) { return catmullRom( a.*m, b.*m, c.*m, d.*m, t ); };
			rings.push_back( { mix( &Ring::z ), std::max( 0.0, mix( &Ring::rx ) ), std::max( 0.0, mix( &Ring::ry ) ),
			    mix( &Ring::cx ), mix( &Ring::cy ), std::max( 1.5, mix( &Ring::exponent ) ) } );
		}
	}
	rings.push_back( keys.back() );
	return rings;
}

std::vector<Ring> domed( std::vector<Ring> rings, double bottom, double top, int steps )
{
	auto dome = [steps]( const Ring& end, double height )
	{
		std::vector<Ring> out; // from next to the end ring to the pole
		for ( int i = 1; i <= steps; ++i )
		{
			const double angle = 0.5 * pi * i / steps, shrink = i == steps ? 0 : std::cos( angle );
			out.push_back(
			    { end.z + height * std::sin( angle ), end.rx * shrink, end.ry * shrink, end.cx, end.cy, end.exponent } );
		}
		return out;
	};
	const double up = rings.back().z >= rings.front().z ? 1 : -1;
	if ( top > 0 )
	{
		const std::vector<Ring> end = dome( rings.back(), up * top );
		rings.insert( rings.end(), end.begin(), end.end() );
	}
	if ( bottom > 0 )
	{
		const std::vector<Ring> end = dome( rings.front(), -up * bottom );
		rings.insert( rings.begin(), end.rbegin(), end.rend() );
	}
	return rings;
}

Mesh lathe( const std::vector<std::array<double, 2>>& profile, int segments, bool caps )
{
	std::vector<Ring> rings;
	for ( auto p : profile )
		rings.push_back( { p[1], p[0], p[0] } );
	return loft( rings, segments, caps );
}

std::vector<std::array<double, 2>> smoothedProfile( const std::vector<std::array<double, 2>>& keys, int steps )
{
	std::vector<Ring> rings;
	for ( auto p : keys )
		rings.push_back( { p[1], p[0], p[0] } );
	std::vector<std::array<double, 2>> profile;
	for ( const Ring& ring : smoothed( rings, steps ) )
		profile.push_back( { ring.rx, ring.z } );
	return profile;
}

Mesh box( Vec3 size )
{
	Mesh mesh;
	for ( int i = 0; i < 8; ++i )
		mesh.vertices.push_back(
		    { ( i & 1 ? 0.5 : -0.5 ) * size.x, ( i & 2 ? 0.5 : -0.5 ) * size.y, ( i & 4 ? 0.5 : -0.5 ) * size.z } );
	const uint32_t faces[6][4] = {
	    { 0, 2, 3, 1 }, { 4, 5, 7, 6 }, { 0, 1, 5, 4 }, { 2, 6, 7, 3 }, { 0, 4, 6, 2 }, { 1, 3, 7, 5 } };
	for ( auto& f : faces )
	{
		mesh.triangles.push_back( { f[0], f[1], f[2] } );
		mesh.triangles.push_back( { f[0], f[2], f[3] } );
	}
	return mesh;
}

Mesh roundedBox( Vec3 size, double radius, int steps )
{
	// Grid lines on each cube face: `steps` in each rim, placed so that the projected angles are equal; every grid point
	// is pushed out to `radius` from the inner box.
	const double half[3] = { 0.5 * size.x, 0.5 * size.y, 0.5 * size.z };
	auto line = [&]( int axis )
	{
		std::vector<double> at_;
		for ( int i = 0; i <= steps; ++i )
			at_.push_back( -half[axis] + radius * ( 1 - std::tan( 0.25 * pi * ( steps - i ) / steps ) ) );
		for ( int i = steps; i >= 0; --i )
			at_.push_back( -at_[static_cast<size_t>( i )] );
		return at_;
	};
	Mesh mesh;
	for ( int axis = 0; axis < 3; ++axis )
		for ( int side = -1; side <= 1; side += 2 )
		{
			const int u = ( axis + 1 ) % 3, v = ( axis + 2 ) % 3;
			const std::vector<double> us = line( u ), vs = line( v );
			const auto base = static_cast<uint32_t>( mesh.vertices.size() );
			for ( double b : vs )
				for ( double a : us )
				{
					double p[3], inner[3], d[3];
					p[axis] = side * half[axis];
					p[u] = a;
					p[v] = b;
					for ( int i = 0; i < 3; ++i )
					{
						inner[i] = std::clamp( p[i], -( half[i] - radius ), half[i] - radius );
						d[i] = p[i] - inner[i];
					}
					const Vec3 out = radius * normalised( { d[0], d[1], d[2] } );
					mesh.vertices.push_back( { inner[0] + out.x, inner[1] + out.y, inner[2] + out.z } );
				}
			const auto w = static_cast<uint32_t>( us.size() );
			for ( uint32_t j = 0; j + 1 < vs.size(); ++j )
				for ( uint32_t i = 0; i + 1 < w; ++i )
				{
					uint32_t a = base + j * w + i, b = a + 1, c = a + w + 1, e = a + w;
					if ( side < 0 )
						std::swap( b, e );
					mesh.triangles.push_back( { a, b, c } );
					mesh.triangles.push_back( { a, c, e } );
				}
		}
	return mesh;
}

Mesh chamferedBox( Vec3 size, double chamfer )
{
	// each corner is cut into a triangle: its vertex `axis` lies on the face of that axis
	const double half[3] = { 0.5 * size.x, 0.5 * size.y, 0.5 * size.z };
	Mesh mesh;
	for ( int corner = 0; corner < 8; ++corner )
		for ( int axis = 0; axis < 3; ++axis )
		{
			double p[3];
			for ( int i = 0; i < 3; ++i )
				p[i] = ( corner >> i & 1 ? 1 : -1 ) * ( half[i] - ( i == axis ? 0 : chamfer ) );
			mesh.vertices.push_back( { p[0], p[1], p[2] } );
		}
	auto vertex = []( int corner, int axis ) { return static_cast<uint32_t>( 3 * corner + axis ); };
	auto triangle = [&mesh]( uint32_t a, uint32_t b, uint32_t c )
	{
		// the box is convex around the origin, which tells outside from inside
		const Vec3 p = mesh.vertices[a], normal = cross( mesh.vertices[b] - p, mesh.vertices[c] - p );
		mesh.triangles.push_back(
		    dot( normal, p ) > 0 ? std::array<uint32_t, 3>{ a, b, c } : std::array<uint32_t, 3>{ a, c, b } );
	};
	auto quad = [&triangle]( uint32_t a, uint32_t b, uint32_t c, uint32_t d )
	{
		triangle( a, b, c );
		triangle( a, c, d );
	};
	for ( int axis = 0; axis < 3; ++axis )
	{
		const int u = 1 << ( axis + 1 ) % 3, v = 1 << ( axis + 2 ) % 3, w = 1 << axis;
		for ( int side : { 0, w } ) // faces
			quad( vertex( side, axis ), vertex( side | u, axis ), vertex( side | u | v, axis ), vertex( side | v, axis ) );
		for ( int other : { 0, u, v, u | v } ) // edges along the axis
			quad( vertex( other, ( axis + 1 ) % 3 ), vertex( other | w, ( axis + 1 ) % 3 ),
			    vertex( other | w, ( axis + 2 ) % 3 ), vertex( other, ( axis + 2 ) % 3 ) );
	}
	for ( int corner = 0; corner < 8; ++corner )
		triangle( vertex( corner, 0 ), vertex( corner, 1 ), vertex( corner, 2 ) );
	return mesh;
}

Mesh board( Vec3 low, Vec3 high, double bevel, int steps )
{
	const Vec3 size = high - low, centre = 0.5 * ( low + high );
	const Mesh mesh = steps > 0 ? roundedBox( size, bevel, steps ) : chamferedBox( size, bevel );
	return mesh.placed( at( centre.x, centre.y, centre.z ) );
}

Mesh sphere( double radius, int segments, int rings )
{
	std::vector<std::array<double, 2>> profile;
	for ( int i = 0; i <= rings; ++i )
	{
		const double angle = pi * i / rings;
		profile.push_back( { i == 0 || i == rings ? 0 : radius * std::sin( angle ), -radius * std::cos( angle ) } );
	}
	return lathe( profile, segments );
}

Mesh drum( double radius, double z0, double z1, double bevel, int segments )
{
	return lathe( { { 0, z0 }, { radius - bevel, z0 }, { radius, z0 + bevel }, { radius, z1 - bevel },
	                  { radius - bevel, z1 }, { 0, z1 } },
	    segments );
}

Mesh tube( const std::vector<Vec3>& path, double radius, int segments, bool closed )
{
	// the frame is carried along by the smallest rotation, so the pipe does not twist
	const size_t count = path.size();
	Mesh mesh;
	Vec3 side;
	for ( size_t k = 0; k < count; ++k )
	{
		const Vec3 before = path[k > 0 ? k - 1 : ( closed ? count - 1 : 0 )],
		           after = path[k + 1 < count ? k + 1 : ( closed ? 0 : k )];
		const Vec3 in = normalised( path[k] - before ), out = normalised( after - path[k] ), along = normalised( in + out );
		if ( k == 0 )
			side = normalised( cross( along, std::fabs( along.z ) < 0.9 ? Vec3{ 0, 0, 1 } : Vec3{ 1, 0, 0 } ) );
		side = normalised( side - dot( side, along ) * along );
		const Vec3 up = cross( along, side );
		for ( int i = 0; i < segments; ++i )
		{
			const double angle = 2 * pi * i / segments;
			mesh.vertices.push_back( path[k] + radius * ( std::cos( angle ) * side + std::sin( angle ) * up ) );
		}
	}
	const auto n = static_cast<uint32_t>( segments ), rows = static_cast<uint32_t>( count );
	for ( uint32_t k = 0; k + ( closed ? 0 : 1 ) < rows; ++k )
		for ( uint32_t i = 0; i < n; ++i )
		{
			const uint32_t a = k * n + i, b = k * n + ( i + 1 ) % n, c = ( k + 1 ) % rows * n + i,
			               d = ( k + 1 ) % rows * n + ( i + 1 ) % n;
			mesh.triangles.push_back( { a, b, d } );
			mesh.triangles.push_back( { a, d, c } );
		}
	if ( !closed )
		for ( uint32_t i = 1; i + 1 < n; ++i )
		{
			const uint32_t end = ( rows - 1 ) * n;
			mesh.triangles.push_back( { 0, i + 1, i } );
			mesh.triangles.push_back( { end, end + i, end + i + 1 } );
		}
	return mesh;
}

std::vector<Vec3> rounded( const std::vector<Vec3>& path, double fillet, int steps )
{
	std::vector<Vec3> out = { path.front() };
	for ( size_t k = 1; k + 1 < path.size(); ++k )
	{
		const Vec3 p = path[k], a = p + fillet * normalised( path[k - 1] - p ),
		           b = p + fillet * normalised( path[k + 1] - p );
		for ( int i = 0; i <= steps; ++i )
		{
			const double t = static_cast<double>( i ) / steps;
			out.push_back( ( 1 - t ) * ( 1 - t ) * a + 2 * t * ( 1 - t ) * p + t * t * b );
		}
	}
	out.push_back( path.back() );
	return out;
}

std::vector<Vec3> circle( double radius, double z, int points )
{
	std::vector<Vec3> out;
	for ( int i = 0; i < points; ++i )
		out.push_back( { radius * std::cos( 2 * pi * i / points ), radius * std::sin( 2 * pi * i / points ), z } );
	return out;
}

std::string toStl( const Mesh& mesh )
{
	static_assert( sizeof( float ) == 4, "STL floats are 32 bit" );
	std::string bytes = "leeway kitchen demo";
	bytes.resize( 80, ' ' );
	auto put = [&bytes]( const void* data, size_t size ) { bytes.append( static_cast<const char*>( data ), size ); };
	auto putVec = [&put]( Vec3 v )
	{
		const float f[3] = { static_cast<float>( v.x ), static_cast<float>( v.y ), static_cast<float>( v.z ) };
		put( f, sizeof f );
	};
	const auto count = static_cast<uint32_t>( mesh.triangles.size() );
	put( &count, 4 );
	for ( auto t : mesh.triangles )
	{
		const Vec3 a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
		putVec( normalised( cross( b - a, c - a ) ) );
		putVec( a );
		putVec( b );
		putVec( c );
		put( "\0\0", 2 );
	}
	return bytes;
}

std::string toObj( const Mesh& mesh )
{
	std::string text = "# leeway kitchen demo\n";
	for ( Vec3 v : mesh.vertices )
		text += fmt::format( "v {:.6f} {:.6f} {:.6f}\n", v.x, v.y, v.z );
	for ( auto t : mesh.triangles )
		text += fmt::format( "f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1 );
	return text;
}

} // namespace kitchen
