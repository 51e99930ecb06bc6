// SPDX-License-Identifier: BSD-3-Clause
// Comparison A: two meshes over a sweep of separations.
#include "peers/peer_workloads.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace
{

double uniform( std::mt19937_64& random )
{
	return static_cast<double>( random() >> 11 ) * 0x1p-53;
}

/// A closed surface over a grid of directions, radius by direction. 2 columns (rows - 1) triangles.
template <typename Radius> Mesh roundMesh( std::uint32_t columns, std::uint32_t rows, const Radius& radius )
{
	Mesh mesh;
	for ( std::uint32_t row = 0; row <= rows; ++row )
	{
		for ( std::uint32_t column = 0; column < columns; ++column )
		{
			const double along = M_PI * row / rows, around = 2 * M_PI * column / columns;
			const double n[3] = {
			    std::sin( along ) * std::cos( around ), std::sin( along ) * std::sin( around ), std::cos( along ) };
			for ( const double x : n )
			{
				mesh.vertices.push_back( radius( n ) * x );
			}
		}
	}
	for ( std::uint32_t row = 0; row < rows; ++row )
	{
		for ( std::uint32_t column = 0; column < columns; ++column )
		{
			const std::uint32_t next = ( column + 1 ) % columns, here = row * columns, below = here + columns;
			mesh.triangles.insert( mesh.triangles.end(), { here + column, below + column, here + next } );
			mesh.triangles.insert( mesh.triangles.end(), { here + next, below + column, below + next } );
		}
	}
	return mesh;
}

Mesh cube()
{
	Mesh mesh;
	for ( int corner = 0; corner < 8; ++corner )
	{
		mesh.vertices.insert(
		    mesh.vertices.end(), { corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5, corner & 4 ? 0.5 : -0.5 } );
	}
	mesh.triangles = {
	    0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5 };
	return mesh;
}

lw_transform randomTurn( std::mt19937_64& random )
{
	double q[4], norm = 0;
	const double zero[3] = { 0, 0, 0 };
	for ( double& x : q )
	{
		x = std::sqrt( -2 * std::log( 1 - uniform( random ) ) ) * std::cos( 2 * M_PI * uniform( random ) );
		norm += x * x;
	}
	for ( double& x : q )
	{
		x /= std::sqrt( norm );
	}
	lw_transform turn;
	leeway::require( lw_transform_from_quaternion( zero, q, &turn ), "a turn" );
	return turn;
}

/// One mesh against itself, at pairs of poses.
class MeshPair
{
public:
	MeshPair( const Mesh& mesh, const std::vector<PeerLibrary>& peers ) : m_shape( shapeOf( mesh ) )
	{
		const lw_query_def def = lw_query_def_default();
		lw_query* query = nullptr;
		leeway::require( lw_query_create( &def, nullptr, nullptr, nullptr, &query ), "a query" );
		m_query.reset( query );
		PeerGeometry geometry{ LW_SHAPE_MESH, { 0, 0, 0 } };
		geometry.vertices = mesh.vertices.data();
		geometry.vertex_count = static_cast<std::uint32_t>( mesh.vertices.size() / 3 );
		geometry.triangles = mesh.triangles.data();
		geometry.triangle_count = static_cast<std::uint32_t>( mesh.triangles.size() / 3 );
		for ( const PeerLibrary& peer : peers )
		{
			if ( peer.managers )
			{
				continue; // nothing to manage
			}
			m_engines.push_back( peer.make() );
			m_engines.back()->add( m_shape.get(), geometry );
			m_engines.back()->add( this, geometry ); // one of its own: some keep state of the last question in it
		}
	}

	/// Turned at random, then moved along the line between their nearest points until that is `gap` long: no other pair of
	/// points comes nearer than that, by the triangle inequality.
	void addRandom( double gap, std::mt19937_64& random )
	{
		lw_transform a = randomTurn( random ), b = randomTurn( random );
		b.t[0] = 4;
		const lw_clearance c = measure( a, b );
		const double share = ( c.upper - gap ) / c.upper;
		b.t[0] += share * ( c.point_a.x - c.point_b.x );
		b.t[1] += share * ( c.point_a.y - c.point_b.y );
		b.t[2] += share * ( c.point_a.z - c.point_b.z );
		m_poses.emplace_back( a, b );
	}

	/// Unit cubes face to face, shifted sideways: all of two large surfaces is about as near, the worst case of all trees.
	void addFacing( double gap, std::mt19937_64& random )
	{
		lw_transform b = lw_transform_identity();
		b.t[0] = 1 + gap;
		b.t[1] = 0.4 * uniform( random ) - 0.2;
		b.t[2] = 0.4 * uniform( random ) - 0.2;
		m_poses.emplace_back( lw_transform_identity(), b );
	}

	/// @param gap of all poses, true by construction
	void run( const std::string& workload, double gap, int repetitions, PeerReport& out )
	{
		std::vector<Asked> asked;
		asked.push_back( { { "leeway", [this]( const double* state )
		    {
			    const auto& [a, b] = m_poses[numberOf( state )];
			    const lw_clearance c = measure( a, b );
			    return Answer{ c.lower, c.upper };
		    } } } );
		for ( const auto& engine : m_engines )
		{
			asked.push_back( { { engine->name(), [this, e = engine.get()]( const double* state )
			    {
				    const auto& [a, b] = m_poses[numberOf( state )];
				    e->place( 0, a );
				    e->place( 1, b );
				    return single( e->distance( 0, 1, INFINITE, 0 ) );
			    } } } );
		}
		Trial trial( { "exact" }, asked,
		    [this]( std::size_t i, double bound )
		    {
			    const auto& [a, b] = m_poses[i];
			    return bruteForce( m_brute, { { m_shape.get(), m_shape.get(), a, b } }, bound );
		    } );
		trial.run( m_poses.size(), repetitions, std::vector<double>( m_poses.size(), gap ) );
		trial.report( out, workload, where( trial.truth(), []( double ) { return true; } ) );
		m_poses.clear();
	}

private:
	lw_clearance measure( const lw_transform& a, const lw_transform& b )
	{
		lw_clearance c;
		leeway::require(
		    lw_shape_distance( m_shape.get(), &a, m_shape.get(), &b, nullptr, m_query.get(), &c ), "a distance" );
		return c;
	}

	leeway::Shape m_shape;
	leeway::Query m_query;
	std::vector<std::unique_ptr<PeerEngine>> m_engines;
	std::vector<std::pair<lw_transform, lw_transform>> m_poses;
	BruteDistance m_brute;
};

} // namespace

leeway::Shape shapeOf( const Mesh& mesh, bool solid )
{
	lw_mesh_def def = lw_mesh_def_default();
	def.vertices = mesh.vertices.data();
	def.vertex_count = static_cast<std::uint32_t>( mesh.vertices.size() / 3 );
	def.indices = mesh.triangles.data();
	def.triangle_count = static_cast<std::uint32_t>( mesh.triangles.size() / 3 );
	def.solid = solid;
	lw_shape* shape = nullptr;
	lw_diag diag{};
	leeway::require( lw_shape_create_mesh( &def, nullptr, &diag, &shape ), diag );
	return leeway::Shape::adopt( shape );
}

Mesh refined( const Mesh& mesh )
{
	Mesh out;
	out.vertices = mesh.vertices;
	std::unordered_map<std::uint64_t, std::uint32_t> middles;
	middles.reserve( mesh.triangles.size() / 2 );
	const auto middle = [&]( std::uint32_t a, std::uint32_t b )
	{
		const auto [found, is_new] = middles.try_emplace( std::uint64_t{ std::min( a, b ) } << 32 | std::max( a, b ),
		    static_cast<std::uint32_t>( out.vertices.size() / 3 ) );
		for ( std::size_t k = 0; k < 3 && is_new; ++k )
		{
			out.vertices.push_back( 0.5 * ( out.vertices[3 * a + k] + out.vertices[3 * b + k] ) );
		}
		return found->second;
	};
	for ( std::size_t i = 0; i < mesh.triangles.size(); i += 3 )
	{
		const std::uint32_t a = mesh.triangles[i], b = mesh.triangles[i + 1], c = mesh.triangles[i + 2];
		const std::uint32_t ab = middle( a, b ), bc = middle( b, c ), ca = middle( c, a );
		out.triangles.insert( out.triangles.end(), { a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca } );
	}
	return out;
}

void runMeshes( const PeersSettings& settings, const std::vector<PeerLibrary>& peers, PeerReport& out )
{
	std::mt19937_64 random( settings.seed );
	const auto bumpy = []( const double n[3] )
	{
		return 0.5 + 0.06 * std::sin( 7 * n[0] + 2 ) * std::sin( 6 * n[1] ) +
		       0.04 * std::sin( 11 * n[2] ) * std::cos( 9 * n[0] );
	};
	const std::pair<const char*, Mesh> meshes[] = {
	    { "two cubes", cube() }, { "two organic meshes", roundMesh( 142, 71, bumpy ) } };
	for ( const auto& [name, mesh] : meshes )
	{
		MeshPair pair( mesh, peers );
		for ( const double gap : { 0.001, 0.01, 0.1, 1.0 } )
		{
			for ( int i = 0; i < ( settings.quick ? 10 : 40 ); ++i )
			{
				pair.addRandom( gap, random );
			}
			char text[96];
			std::snprintf( text, sizeof text, "A %s of %zu triangles, %g m apart", name, mesh.triangles.size() / 3, gap );
			pair.run( text, gap, settings.repetitions, out );
		}
	}
	Mesh fine = cube();
	for ( int level = 0; level < 5; ++level )
	{
		fine = refined( fine );
	}
	MeshPair cubes( fine, peers );
	for ( const double gap : { 0.01, 0.1, 1.0 } )
	{
		for ( int i = 0; i < ( settings.quick ? 5 : 20 ); ++i )
		{
			cubes.addFacing( gap, random );
		}
		char text[96];
		std::snprintf(
		    text, sizeof text, "A two parallel cubes of %zu triangles, %g m apart", fine.triangles.size() / 3, gap );
		cubes.run( text, gap, settings.repetitions, out );
	}
}
