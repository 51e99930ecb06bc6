// SPDX-License-Identifier: BSD-3-Clause
// Binary glTF 2.0 (Khronos, ISO/IEC 12113:2022): a JSON chunk that describes, a binary chunk that holds the numbers.
#include "gltf.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace kitchen
{

namespace
{

using Double3 = std::array<double, 3>;

Double3 sub( const Double3& a, const Double3& b )
{
	return { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
}

double dot3( const Double3& a, const Double3& b )
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Double3 unit( const Double3& a )
{
	const double l = std::sqrt( dot3( a, a ) );
	return l > 0 ? Double3{ a[0] / l, a[1] / l, a[2] / l } : Double3{ 0, 0, 0 };
}

Double3 cross3( const Double3& a, const Double3& b )
{
	return { a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0] };
}

double linear( double srgb )
{
	return srgb <= 0.04045 ? srgb / 12.92 : std::pow( ( srgb + 0.055 ) / 1.055, 2.4 );
}

constexpr int float_component = 5126, uint_component = 5125, array_target = 34962, index_target = 34963;

} // namespace

ShadedMesh shade(
    const double* vertices, size_t vertex_count, const uint32_t* triangles, size_t triangle_count, double crease )
{
	// one id per position
	std::map<Double3, uint32_t> ids;
	std::vector<uint32_t> id( vertex_count );
	for ( size_t v = 0; v < vertex_count; ++v )
		id[v] = ids.emplace( Double3{ vertices[3 * v], vertices[3 * v + 1], vertices[3 * v + 2] },
		               static_cast<uint32_t>( ids.size() ) )
		            .first->second;
	std::vector<Double3> point( ids.size() );
	for ( const auto& [p, i] : ids )
		point[i] = p;

	struct Corner
	{
		size_t triangle;
		double angle;
	};
	std::vector<std::vector<Corner>> around( point.size() );
	std::vector<Double3> face( triangle_count );
	for ( size_t t = 0; t < triangle_count; ++t )
	{
		const Double3 p[3] = {
		    point[id[triangles[3 * t]]], point[id[triangles[3 * t + 1]]], point[id[triangles[3 * t + 2]]] };
		face[t] = unit( cross3( sub( p[1], p[0] ), sub( p[2], p[0] ) ) );
		for ( int c = 0; c < 3; ++c )
		{
			const Double3 a = unit( sub( p[( c + 1 ) % 3], p[c] ) ), b = unit( sub( p[( c + 2 ) % 3], p[c] ) );
			around[id[triangles[3 * t + static_cast<size_t>( c )]]].push_back(
			    { t, std::acos( std::clamp( dot3( a, b ), -1.0, 1.0 ) ) } );
		}
	}

	ShadedMesh mesh;
	const double smooth = std::cos( crease );
	std::map<std::array<float, 6>, uint32_t> made;
	for ( size_t t = 0; t < triangle_count; ++t )
	{
		if ( dot3( face[t], face[t] ) == 0 )
			continue; // a degenerate triangle shows nothing
		for ( int c = 0; c < 3; ++c )
		{
			const uint32_t v = id[triangles[3 * t + static_cast<size_t>( c )]];
			Double3 sum = { 0, 0, 0 };
			for ( const Corner& corner : around[v] )
				if ( dot3( face[corner.triangle], face[t] ) >= smooth )
					for ( size_t i = 0; i < 3; ++i )
						sum[i] += corner.angle * face[corner.triangle][i];
			const Double3 n = unit( sum );
			std::array<float, 6> key;
			for ( size_t i = 0; i < 3; ++i )
			{
				key[i] = static_cast<float>( point[v][i] );
				key[3 + i] = static_cast<float>( n[i] );
			}
			const auto [it, fresh] = made.emplace( key, static_cast<uint32_t>( made.size() ) );
			if ( fresh )
			{
				mesh.positions.insert( mesh.positions.end(), key.begin(), key.begin() + 3 );
				mesh.normals.insert( mesh.normals.end(), key.begin() + 3, key.end() );
			}
			mesh.indices.push_back( it->second );
		}
	}
	return mesh;
}

Gltf::Gltf()
{
	m_json["asset"] = { { "version", "2.0" }, { "generator", "leeway examples/kitchen" } };
	m_json["scene"] = 0;
	m_json["scenes"] = { { { "nodes", { 0 } } } };
	m_json["buffers"] = nlohmann::json::array();
	for ( const char* list : { "nodes", "meshes", "materials", "accessors", "bufferViews" } )
		m_json[list] = nlohmann::json::array();
	// glTF's y is up, ours is z
	const double h = std::sqrt( 0.5 );
	m_json["nodes"].push_back(
	    { { "name", "z_up" }, { "rotation", { -h, 0, 0, h } }, { "children", nlohmann::json::array() } } );
}

int Gltf::addAccessor( const void* data, size_t bytes, int count, int component, const char* type, int target,
    const nlohmann::json& low, const nlohmann::json& high )
{
	nlohmann::json view = { { "buffer", 0 }, { "byteOffset", m_binary.size() }, { "byteLength", bytes } };
	if ( target )
		view["target"] = target;
	m_binary.append( static_cast<const char*>( data ), bytes );
	m_json["bufferViews"].push_back( view );
	nlohmann::json accessor = { { "bufferView", m_json["bufferViews"].size() - 1 }, { "componentType", component },
	    { "count", count }, { "type", type } };
	if ( !low.is_null() )
	{
		accessor["min"] = low;
		accessor["max"] = high;
	}
	m_json["accessors"].push_back( accessor );
	return static_cast<int>( m_json["accessors"].size() ) - 1;
}

int Gltf::addMaterial( const Surface& surface )
{
	nlohmann::json material = { { "name", surface.name },
	    { "pbrMetallicRoughness", { { "baseColorFactor", { linear( surface.colour[0] ), linear( surface.colour[1] ),
	                                                         linear( surface.colour[2] ), surface.colour[3] } },
	                                  { "metallicFactor", surface.metallic }, { "roughnessFactor", surface.roughness } } } };
	if ( surface.colour[3] < 1 )
		material["alphaMode"] = "BLEND";
	m_json["materials"].push_back( material );
	return static_cast<int>( m_json["materials"].size() ) - 1;
}

int Gltf::addGeometry( const ShadedMesh& mesh )
{
	std::array<float, 3> low = { 0, 0, 0 }, high = { 0, 0, 0 };
	for ( size_t i = 0; i < mesh.positions.size(); ++i )
	{
		low[i % 3] = i < 3 ? mesh.positions[i] : std::min( low[i % 3], mesh.positions[i] );
		high[i % 3] = i < 3 ? mesh.positions[i] : std::max( high[i % 3], mesh.positions[i] );
	}
	const int count = static_cast<int>( mesh.positions.size() / 3 );
	const int first = addAccessor(
	    mesh.positions.data(), 4 * mesh.positions.size(), count, float_component, "VEC3", array_target, low, high );
	addAccessor(
	    mesh.normals.data(), 4 * mesh.normals.size(), count, float_component, "VEC3", array_target, nullptr, nullptr );
	addAccessor( mesh.indices.data(), 4 * mesh.indices.size(), static_cast<int>( mesh.indices.size() ), uint_component,
	    "SCALAR", index_target, nullptr, nullptr );
	return first;
}

int Gltf::addMesh( int geometry, int material )
{
	m_json["meshes"].push_back(
	    { { "primitives", { { { "attributes", { { "POSITION", geometry }, { "NORMAL", geometry + 1 } } },
	                          { "indices", geometry + 2 }, { "material", material } } } } } );
	return static_cast<int>( m_json["meshes"].size() ) - 1;
}

int Gltf::addTranslucentMesh( int geometry, int material )
{
	// COLOR_0 is multiplied with the base colour, whose factor therefore moves into the vertices
	nlohmann::json& factor = m_json["materials"][static_cast<size_t>( material )]["pbrMetallicRoughness"]["baseColorFactor"];
	nlohmann::json& rest = m_json["materials"][static_cast<size_t>( material )]["extras"];
	if ( rest.is_null() )
	{
		rest = { { "colour", factor } };
		factor = { 1.0, 1.0, 1.0, 1.0 };
	}
	const std::vector<float> colour = rest["colour"].get<std::vector<float>>();
	const int count = m_json["accessors"][static_cast<size_t>( geometry )]["count"];
	std::vector<float> data;
	for ( int i = 0; i < count; ++i )
		data.insert( data.end(), colour.begin(), colour.end() );
	const int accessor =
	    addAccessor( data.data(), 4 * data.size(), count, float_component, "VEC4", array_target, nullptr, nullptr );
	const int mesh = addMesh( geometry, material );
	m_json["meshes"][static_cast<size_t>( mesh )]["primitives"][0]["attributes"]["COLOR_0"] = accessor;
	return mesh;
}

int Gltf::addNode( const std::string& name, int parent, const Vec& translation, const Quat& rotation, int mesh )
{
	nlohmann::json node = { { "name", name }, { "translation", translation }, { "rotation", rotation } };
	if ( mesh >= 0 )
		node["mesh"] = mesh;
	m_json["nodes"].push_back( node );
	const int index = static_cast<int>( m_json["nodes"].size() ) - 1;
	m_json["nodes"][static_cast<size_t>( parent < 0 ? 0 : parent )]["children"].push_back( index );
	return index;
}

int Gltf::addTimes( const std::vector<double>& times )
{
	if ( m_times_accessor >= 0 && m_times == times )
		return m_times_accessor;
	const std::vector<float> data( times.begin(), times.end() );
	m_times = times;
	m_times_accessor = addAccessor( data.data(), 4 * data.size(), static_cast<int>( data.size() ), float_component, "SCALAR",
	    0, { data.front() }, { data.back() } );
	return m_times_accessor;
}

void Gltf::animate(
    int node, const std::vector<double>& times, const std::vector<Vec>& translations, const std::vector<Quat>& rotations )
{
	if ( !m_json.contains( "animations" ) )
		m_json["animations"] = {
		    { { "name", "path" }, { "samplers", nlohmann::json::array() }, { "channels", nlohmann::json::array() } } };
	std::vector<float> moves, turns;
	Quat last = rotations.front();
	for ( size_t i = 0; i < times.size(); ++i )
	{
		moves.insert( moves.end(), translations[i].begin(), translations[i].end() );
		// q and -q are the same pose; the nearer one keeps viewers from interpolating the long way round
		double towards = 0;
		for ( size_t k = 0; k < 4; ++k )
			towards += rotations[i][k] * last[k];
		for ( size_t k = 0; k < 4; ++k )
			last[k] = ( towards < 0 ? -1 : 1 ) * rotations[i][k];
		turns.insert( turns.end(), last.begin(), last.end() );
	}
	const int input = addTimes( times ), count = static_cast<int>( times.size() );
	const int outputs[2] = {
	    addAccessor( moves.data(), 4 * moves.size(), count, float_component, "VEC3", 0, nullptr, nullptr ),
	    addAccessor( turns.data(), 4 * turns.size(), count, float_component, "VEC4", 0, nullptr, nullptr ) };
	nlohmann::json& animation = m_json["animations"][0];
	for ( int i = 0; i < 2; ++i )
	{
		animation["samplers"].push_back( { { "input", input }, { "output", outputs[i] }, { "interpolation", "LINEAR" } } );
		animation["channels"].push_back( { { "sampler", animation["samplers"].size() - 1 },
		    { "target", { { "node", node }, { "path", i ? "rotation" : "translation" } } } } );
	}
}

std::string Gltf::bytes() const
{
	nlohmann::json json = m_json;
	json["buffers"].push_back( { { "byteLength", m_binary.size() } } );
	std::string text = json.dump(), binary = m_binary;
	text.resize( ( text.size() + 3 ) / 4 * 4, ' ' );
	binary.resize( ( binary.size() + 3 ) / 4 * 4, '\0' );
	std::string out;
	auto put = [&out]( uint32_t value ) { out.append( reinterpret_cast<const char*>( &value ), 4 ); };
	put( 0x46546C67 ); // "glTF"
	put( 2 );
	put( static_cast<uint32_t>( 12 + 8 + text.size() + 8 + binary.size() ) );
	put( static_cast<uint32_t>( text.size() ) );
	put( 0x4E4F534A ); // "JSON"
	out += text;
	put( static_cast<uint32_t>( binary.size() ) );
	put( 0x004E4942 ); // "BIN"
	return out + binary;
}

} // namespace kitchen
