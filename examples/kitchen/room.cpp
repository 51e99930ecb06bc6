// SPDX-License-Identifier: BSD-3-Clause
// The kitchen: a room corner of 4.2 x 3.6 m. Along the back wall (y = 3.6, from the left): fridge, drawers, sink, cupboard,
// oven with hob, counter, each with the cupboards above it; a sideboard on the left wall (x = 0); a table with chairs in
// front.
#include "crockery.hpp"
#include "model.hpp"

#include <fmt/format.h>

#include <stdexcept>

namespace kitchen
{

const std::vector<Material>& materials()
{
	static const std::vector<Material> all = { // robot
	    { "shell", 0.93, 0.93, 0.92, 1, 0.35, 0 }, { "grey", 0.62, 0.64, 0.66, 1, 0.40, 0.1 },
	    { "graphite", 0.16, 0.17, 0.19, 1, 0.45, 0.2 }, { "accent", 0.96, 0.46, 0.10, 1, 0.35, 0 },
	    { "visor", 0.05, 0.07, 0.10, 1, 0.12, 0.3 }, { "eye", 0.30, 0.85, 0.95, 1, 0.20, 0 },
	    // room
	    { "wall", 0.93, 0.90, 0.84, 1, 0.95, 0 }, { "floor", 0.74, 0.66, 0.56, 1, 0.70, 0 },
	    { "tile", 0.90, 0.92, 0.90, 1, 0.25, 0 }, { "front", 0.36, 0.50, 0.49, 1, 0.55, 0 },
	    { "carcass", 0.88, 0.87, 0.83, 1, 0.60, 0 }, { "oak", 0.76, 0.57, 0.37, 1, 0.55, 0 },
	    { "walnut", 0.46, 0.31, 0.20, 1, 0.55, 0 }, { "plinth", 0.20, 0.24, 0.24, 1, 0.70, 0 },
	    { "window", 0.72, 0.87, 0.96, 1, 0.15, 0 },
	    // things
	    { "steel", 0.78, 0.79, 0.80, 1, 0.28, 0.9 }, { "iron", 0.13, 0.13, 0.14, 1, 0.50, 0.4 },
	    { "black_glass", 0.06, 0.06, 0.07, 1, 0.10, 0.1 }, { "enamel", 0.95, 0.95, 0.94, 1, 0.25, 0 },
	    { "copper", 0.83, 0.47, 0.30, 1, 0.30, 0.9 }, { "porcelain", 0.96, 0.95, 0.92, 1, 0.20, 0 },
	    { "blue_glaze", 0.22, 0.38, 0.62, 1, 0.25, 0 }, { "red_glaze", 0.78, 0.20, 0.16, 1, 0.25, 0 },
	    { "yellow", 0.95, 0.75, 0.22, 1, 0.40, 0 }, { "green_glass", 0.16, 0.38, 0.22, 1, 0.10, 0 },
	    { "milk", 0.95, 0.95, 0.97, 1, 0.20, 0 }, { "jam", 0.60, 0.10, 0.16, 1, 0.20, 0 },
	    { "apple", 0.80, 0.16, 0.13, 1, 0.35, 0 }, { "pear", 0.62, 0.72, 0.22, 1, 0.40, 0 },
	    { "orange", 0.97, 0.55, 0.10, 1, 0.50, 0 }, { "leaf", 0.28, 0.52, 0.24, 1, 0.60, 0 },
	    { "terracotta", 0.75, 0.40, 0.27, 1, 0.85, 0 }, { "bread", 0.72, 0.46, 0.22, 1, 0.85, 0 },
	    { "linen", 0.93, 0.87, 0.74, 1, 0.90, 0 } };
	return all;
}

const Material& material( const std::string& name )
{
	for ( const Material& candidate : materials() )
		if ( name == candidate.name )
			return candidate;
	throw std::out_of_range( "no material " + name );
}

size_t Room::triangles() const
{
	size_t count = 0;
	for ( const Object& object : objects )
		for ( const Placed& shape : object.shapes )
			if ( shape.part >= 0 )
				count += parts[static_cast<size_t>( shape.part )].mesh.triangles.size();
	return count;
}

namespace
{

/// Collects distinct meshes and the objects made of them.
class Builder
{
public:
	int part( const std::string& file, const Mesh& mesh, const std::string& material_name )
	{
		room.parts.push_back( { file, mesh, material( material_name ).name } );
		return static_cast<int>( room.parts.size() ) - 1;
	}

	/// A new object at a pose, of one or more parts.
	Object& object( const std::string& id, const std::vector<int>& parts, const Pose& pose = {} )
	{
		room.objects.push_back( { id, {} } );
		for ( int p : parts )
			room.objects.back().shapes.push_back( { p, "", {}, "", pose } );
		return room.objects.back();
	}

	void solid( const std::string& id, Vec3 low, Vec3 high, const std::string& material_name )
	{
		object( id, {} );
		solid( low, high, material_name );
	}

	/// Another box for the newest object.
	void solid( Vec3 low, Vec3 high, const std::string& material_name )
	{
		const Vec3 size = high - low, c = 0.5 * ( low + high );
		room.objects.back().shapes.push_back(
		    { -1, "box", { size.x, size.y, size.z }, material( material_name ).name, at( c.x, c.y, c.z ) } );
	}

	void cylinder( double height, double radius, const std::string& material_name, const Pose& pose )
	{
		room.objects.back().shapes.push_back( { -1, "cylinder", { height, radius }, material( material_name ).name, pose } );
	}

	Room room;
};

constexpr double top = 0.90;   ///< of the counters
constexpr double depth = 0.60; ///< of the counters
constexpr double thick = 0.018;

// Units are modelled with their back at y = 0, front at y = -depth, left side at x = 0, standing on z = 0.

/// Five boards, open to the front.
Mesh carcass( double width, double z0, double z1, double deep )
{
	Mesh mesh = board( { 0, -deep, z0 }, { thick, 0, z1 } );
	mesh.add( board( { width - thick, -deep, z0 }, { width, 0, z1 } ) );
	mesh.add( board( { thick, -deep, z0 }, { width - thick, -0.004, z0 + thick } ) );
	mesh.add( board( { thick, -deep, z1 - thick }, { width - thick, -0.004, z1 } ) );
	return mesh.add( board( { thick, -0.010, z0 + thick }, { width - thick, 0, z1 - thick }, 0.002 ) );
}

/// A bow handle along x (or z), proud of the plane y = 0 towards -y.
Mesh handle( double span, bool upright )
{
	const double h = 0.5 * span;
	const Mesh bow =
	    tube( rounded( { { -h, 0.004, 0 }, { -h, -0.032, 0 }, { h, -0.032, 0 }, { h, 0.004, 0 } }, 0.014, 4 ), 0.0055, 10 );
	return upright ? bow.placed( at( 0, 0, 0, 0, 0.5 * pi ) ) : bow;
}

/// Panel in the plane y = 0 (thickness towards -y), x from 0, with a raised frame.
Mesh panel( double width, double height )
{
	Mesh mesh = board( { 0.002, -thick, 0.002 }, { width - 0.002, 0, height - 0.002 } );
	const double rim = 0.055, proud = thick + 0.005;
	if ( height > 3 * rim && width > 3 * rim )
	{
		mesh.add( board( { 0.004, -proud, 0.004 }, { rim, -thick + 0.004, height - 0.004 } ) );
		mesh.add( board( { width - rim, -proud, 0.004 }, { width - 0.004, -thick + 0.004, height - 0.004 } ) );
		mesh.add( board( { rim, -proud, 0.004 }, { width - rim, -thick + 0.004, rim } ) );
		mesh.add( board( { rim, -proud, height - rim }, { width - rim, -thick + 0.004, height - 0.004 } ) );
	}
	return mesh;
}

/// Door of width w hinged on its left edge (x = 0), or on its right edge.
Mesh doorHandle( double width, double height, bool hinge_left, bool grip_low )
{
	return handle( 0.14, true )
	    .placed( at( hinge_left ? width - 0.03 : 0.03, -thick - 0.004, grip_low ? 0.13 : height - 0.13 ) );
}

/// Sliding box behind a drawer front; open above. x from 0, front at y = 0.
Mesh drawerBox( double width, double height, double deep )
{
	Mesh mesh = board( { 0.02, 0.0, 0.012 }, { 0.034, deep, height } );
	mesh.add( board( { width - 0.034, 0.0, 0.012 }, { width - 0.02, deep, height } ) );
	mesh.add( board( { 0.034, deep - 0.014, 0.012 }, { width - 0.034, deep, height } ) );
	return mesh.add( board( { 0.034, 0.0, 0.012 }, { width - 0.034, deep - 0.014, 0.022 } ) );
}

void addShell( Builder& b )
{
	b.solid( "floor", { -0.1, -0.6, -0.05 }, { 4.8, 3.7, 0 }, "floor" );
	b.solid( "wall_back", { -0.1, 3.6, 0 }, { 4.2, 3.7, 2.5 }, "wall" );
	b.solid( "wall_left", { -0.1, 0, 0 }, { 0, 3.6, 2.5 }, "wall" );
	Mesh tiles; // splash-back: cushioned tiles, five rows
	for ( int row = 0; row < 5; ++row )
		for ( int i = 0; i < 32; ++i )
		{
			const double x = 0.78 + 0.1 * i, z = top + 0.004 + 0.1 * row;
			tiles.add( loft( { { 0, 0.049, 0.049, 0, 0, 12 }, { 0.007, 0.046, 0.046, 0, 0, 12 } }, 8 ),
			    at( x + 0.05, 3.6, z + 0.05, 0.5 * pi ) );
		}
	b.object( "splash_back", { b.part( "splash_back.obj", tiles, "tile" ) } );
	Mesh skirting = board( { 0.0, 0.0, 0.0 }, { 0.016, 3.0, 0.09 }, 0.005 );
	b.object( "skirting", { b.part( "skirting.stl", skirting, "enamel" ) } );
}

void addFridge( Builder& b )
{
	const double w = 0.64, d = 0.62, h = 1.86, wall = 0.035;
	Mesh body = board( { 0, -d, 0.03 }, { wall, 0, h }, 0.012, 2 );
	body.add( board( { w - wall, -d, 0.03 }, { w, 0, h }, 0.012, 2 ) );
	body.add( board( { wall - 0.01, -d, h - wall }, { w - wall + 0.01, 0, h }, 0.012, 2 ) );
	body.add( board( { wall - 0.01, -d, 0.03 }, { w - wall + 0.01, 0, 0.12 }, 0.012, 2 ) );
	body.add( board( { wall - 0.01, -0.04, 0.10 }, { w - wall + 0.01, 0, h - 0.02 }, 0.01, 2 ) );
	for ( int i = 0; i < 4; ++i )
		body.add( drum( 0.022, 0, 0.035, 0.004, 16 ), at( i & 1 ? 0.08 : w - 0.08, i & 2 ? -0.08 : -d + 0.06, 0 ) );
	for ( int i = 0; i < 7; ++i ) // rails
		for ( int side = 0; side < 2; ++side )
			body.add( board( { side ? w - wall - 0.012 : wall, -d + 0.06, 0.395 + 0.2 * i },
			    { side ? w - wall : wall + 0.012, -0.05, 0.405 + 0.2 * i }, 0.004 ) );
	Mesh shelf = board( { 0.042, -d + 0.07, 0.0 }, { w - 0.042, -0.05, 0.008 }, 0.003 );
	Mesh rim = tube( rounded( { { 0.05, -0.05, 0.012 }, { 0.05, -d + 0.068, 0.012 }, { w - 0.05, -d + 0.068, 0.012 },
	                              { w - 0.05, -0.05, 0.012 } },
	                     0.03, 4 ),
	    0.007, 10 );
	Mesh crisper = drawerBox( w - 0.11, 0.19, 0.48 ).placed( at( 0.055, -d + 0.075, 0.12 ) );
	crisper.add( board( { 0.06, -d + 0.05, 0.128 }, { w - 0.06, -d + 0.07, 0.325 }, 0.006, 2 ) );
	crisper.add( handle( 0.22, false ), at( 0.5 * w, -d + 0.05, 0.25 ) );
	const int shelf_part = b.part( "fridge_shelf.stl", shelf, "window" ),
	          rim_part = b.part( "fridge_rim.stl", rim, "steel" );
	const Pose place = at( 0.12, 3.59, 0 );
	Object& fridge = b.object( "fridge",
	    { b.part( "fridge_body.obj", body, "enamel" ), b.part( "fridge_crisper.obj", crisper, "window" ) }, place );
	for ( double z : { 0.40, 0.80, 1.20, 1.50 } )
	{
		fridge.shapes.push_back( { shelf_part, "", {}, "", place * at( 0, 0, z ) } );
		fridge.shapes.push_back( { rim_part, "", {}, "", place * at( 0, 0, z ) } );
	}
	// door: hinged at the left front edge, closed along +x, outside towards -y
	Mesh door = roundedBox( { w, 0.055, h - 0.04 }, 0.014, 3 ).placed( at( 0.5 * w, -0.0275, 0.04 + 0.5 * ( h - 0.04 ) ) );
	for ( int i = 0; i < 4; ++i )
	{
		const double z = 0.30 + 0.40 * i; // racks on the inside
		door.add( board( { 0.06, 0.0, z }, { w - 0.06, 0.10, z + 0.012 }, 0.004 ) );
		door.add( board( { 0.06, 0.090, z }, { w - 0.06, 0.10, z + 0.07 }, 0.004 ) );
		door.add( board( { 0.06, 0.0, z }, { 0.072, 0.10, z + 0.09 }, 0.004 ) );
		door.add( board( { w - 0.072, 0.0, z }, { w - 0.06, 0.10, z + 0.09 }, 0.004 ) );
	}
	const Pose hinge = place * at( 0, -d - 0.004, 0, 0, 0, -1.60 );
	b.object( "fridge_door",
	    { b.part( "fridge_door.obj", door, "enamel" ),
	        b.part( "fridge_handle.stl", handle( 0.42, true ).placed( at( w - 0.045, -0.053, 1.0 ) ), "steel" ) },
	    hinge );
}

void addDrawers( Builder& b, const Pose& place )
{
	const double w = 0.60;
	const int body = b.part( "drawer_carcass.stl", carcass( w, 0.10, 0.86, depth - 0.02 ), "carcass" );
	const int low = b.part( "drawer_low_front.stl", panel( w, 0.30 ), "front" ),
	          high = b.part( "drawer_high_front.stl", panel( w, 0.16 ), "front" );
	const int grip = b.part( "drawer_handle.obj", handle( 0.20, false ).placed( at( 0.5 * w, -thick, 0 ) ), "steel" );
	const int box_high = b.part( "drawer_box.obj", drawerBox( w, 0.13, 0.50 ), "oak" );
	auto drawer = [&]( const std::string& id, const Pose& unit, double z, bool tall, double open )
	{
		const Pose p = unit * at( 0, -depth + 0.02 - open, z );
		Object& object = b.object( id, { tall ? low : high }, p );
		object.shapes.push_back( { grip, "", {}, "", p * at( 0, 0, tall ? 0.24 : 0.08 ) } );
		if ( !tall )
			object.shapes.push_back( { box_high, "", {}, "", p } );
	};
	const Pose units[2] = { place, place * at( 2.60, 0, 0 ) };
	for ( int i = 0; i < 2; ++i )
	{
		const std::string id = i ? "counter_right" : "counter_left";
		b.object( id, { body }, units[i] );
		drawer( id + "_drawer_bottom", units[i], 0.10, true, 0 );
		drawer( id + "_drawer_middle", units[i], 0.40, true, 0 );
		drawer( id + "_drawer_top", units[i], 0.70, false, i ? 0 : 0.34 );
	}
}

void addSink( Builder& b, const Pose& place )
{
	const double w = 0.80;
	const int door = b.part( "sink_door.stl", panel( 0.40, 0.76 ), "front" );
	const int grip_l = b.part( "sink_handle_left.stl", doorHandle( 0.40, 0.76, true, false ), "steel" );
	const int grip_r = b.part( "sink_handle_right.stl", doorHandle( 0.40, 0.76, false, false ), "steel" );
	b.object( "sink_unit", { b.part( "sink_carcass.stl", carcass( w, 0.10, 0.70, depth - 0.02 ), "carcass" ) }, place );
	b.object( "sink_doors", { door, grip_l }, place * at( 0, -depth + 0.02, 0.10 ) );
	for ( int p : { door, grip_r } )
		b.room.objects.back().shapes.push_back( { p, "", {}, "", place * at( 0.40, -depth + 0.02, 0.10 ) } );
	// basin: rolled rim, straight walls, bottom with a drain; outside and inside surface
	const double n = 7;
	Mesh basin =
	    loft( { { -0.200, 0, 0 }, { -0.200, 0.045, 0.045, 0, 0, 2 }, { -0.190, 0.20, 0.14, 0, 0, n },
	              { -0.180, 0.234, 0.174, 0, 0, n }, { -0.02, 0.250, 0.190, 0, 0, n }, { 0.001, 0.254, 0.194, 0, 0, n },
	              { 0.001, 0.282, 0.222, 0, 0, n }, { 0.006, 0.284, 0.224, 0, 0, n }, { 0.010, 0.270, 0.210, 0, 0, n },
	              { 0.006, 0.254, 0.194, 0, 0, n }, { -0.02, 0.247, 0.187, 0, 0, n }, { -0.155, 0.240, 0.180, 0, 0, n },
	              { -0.175, 0.228, 0.168, 0, 0, n }, { -0.182, 0.205, 0.145, 0, 0, n }, { -0.186, 0.08, 0.06, 0, 0, 3 },
	              { -0.188, 0.045, 0.045, 0, 0, 2 }, { -0.196, 0.040, 0.040, 0, 0, 2 }, { -0.196, 0, 0 } },
	        56 );
	basin.add( drum( 0.030, -0.195, -0.188, 0.003, 24 ) );
	basin.add( tube( rounded( { { 0, 0, -0.197 }, { 0, 0, -0.33 }, { 0, 0.20, -0.33 } }, 0.06, 6 ), 0.022, 16 ) );
	b.object( "sink", { b.part( "sink_basin.obj", basin, "steel" ) }, place * at( 0.40, -0.315, top ) );
	Mesh tap = lathe( smoothedProfile( { { 0, 0 }, { 0.030, 0 }, { 0.032, 0.006 }, { 0.022, 0.014 }, { 0.020, 0.06 },
	                                       { 0.017, 0.09 }, { 0, 0.094 } },
	                      3 ),
	    28 );
	tap.add( tube( rounded( { { 0, 0, 0.06 }, { 0, 0, 0.285 }, { 0, -0.185, 0.285 }, { 0, -0.185, 0.175 } }, 0.085, 12 ),
	    0.0115, 16 ) );
	tap.add( drum( 0.015, -0.012, 0.026, 0.003, 20 ), at( 0, -0.185, 0.172 ) );
	tap.add( tube( rounded( { { 0.012, 0, 0.055 }, { 0.045, 0, 0.060 }, { 0.085, -0.015, 0.095 } }, 0.02, 4 ), 0.006, 12 ) );
	tap.add( sphere( 0.010, 14, 8 ), at( 0.086, -0.015, 0.096 ) );
	b.object( "tap", { b.part( "tap.obj", tap, "steel" ) }, place * at( 0.40, -0.065, top ) );
}

void addCupboard( Builder& b, const Pose& place )
{
	const double w = 0.60;
	Mesh body = carcass( w, 0.10, 0.86, depth - 0.02 );
	body.add( board( { thick, -0.50, 0.46 }, { w - thick, -0.01, 0.478 } ) );
	b.object( "cupboard", { b.part( "cupboard_carcass.stl", body, "carcass" ) }, place );
	b.object( "cupboard_door",
	    { b.part( "cupboard_door.stl", panel( w, 0.76 ), "front" ),
	        b.part( "cupboard_handle.stl", doorHandle( w, 0.76, true, false ), "steel" ) },
	    place * at( 0, -depth + 0.018, 0.10, 0, 0, -1.45 ) );
}

void addOven( Builder& b, const Pose& place )
{
	const double w = 0.60, d = depth - 0.02;
	Mesh body = board( { 0, -d, 0.10 }, { 0.045, 0, 0.86 } );
	body.add( board( { w - 0.045, -d, 0.10 }, { w, 0, 0.86 } ) );
	body.add( board( { 0.045, -d, 0.10 }, { w - 0.045, 0, 0.185 } ) );
	body.add( board( { 0.045, -0.05, 0.185 }, { w - 0.045, 0, 0.66 } ) );
	body.add( board( { 0.045, -d, 0.655 }, { w - 0.045, 0, 0.86 } ) );
	for ( int i = 0; i < 5; ++i ) // rails
		for ( int side = 0; side < 2; ++side )
			body.add( tube( { { side ? w - 0.052 : 0.052, -d + 0.03, 0.24 + 0.085 * i },
			                    { side ? w - 0.052 : 0.052, -0.06, 0.24 + 0.085 * i } },
			    0.004, 8 ) );
	Mesh panel_ = roundedBox( { w - 0.006, 0.022, 0.145 }, 0.006, 2 ).placed( at( 0.5 * w, -d - 0.011, 0.775 ) );
	Mesh knobs;
	for ( int i = 0; i < 5; ++i )
	{
		Mesh knob = lathe( smoothedProfile( { { 0, 0 }, { 0.024, 0 }, { 0.024, 0.005 }, { 0.019, 0.008 }, { 0.017, 0.024 },
		                                        { 0.014, 0.027 }, { 0, 0.028 } },
		                       1 ),
		    22 );
		knob.add( board( { -0.003, 0.0, 0.024 }, { 0.003, 0.018, 0.030 }, 0.0015 ) );
		knobs.add( knob, at( 0.10 + 0.10 * i, -d - 0.021, 0.775, 0.5 * pi ) );
	}
	b.object( "oven",
	    { b.part( "oven_body.obj", body, "iron" ), b.part( "oven_panel.stl", panel_, "steel" ),
	        b.part( "oven_knobs.obj", knobs, "graphite" ) },
	    place );
	Mesh rack; // a grid of wires with a frame
	rack.add( tube( rounded( { { 0.30, -0.54, 0 }, { 0.535, -0.54, 0 }, { 0.535, -0.07, 0 }, { 0.065, -0.07, 0 },
	                             { 0.065, -0.54, 0 }, { 0.299, -0.54, 0 } },
	                    0.02, 3 ),
	    0.004, 8 ) );
	for ( int i = 0; i < 12; ++i )
		rack.add( tube( { { 0.095 + 0.0373 * i, -0.54, 0 }, { 0.095 + 0.0373 * i, -0.07, 0 } }, 0.0024, 6 ) );
	const int rack_part = b.part( "oven_rack.stl", rack, "steel" );
	b.object( "oven_rack_low", { rack_part }, place * at( 0, 0, 0.250 ) );
	b.object( "oven_rack_high", { rack_part }, place * at( 0, 0, 0.592 ) );
	// door: hinged below, folded down to the horizontal: modelled closed, bottom edge at z = 0, outside towards -y
	Mesh frame = board( { 0.004, -0.035, 0 }, { 0.085, 0, 0.50 }, 0.005 );
	frame.add( board( { w - 0.085, -0.035, 0 }, { w - 0.004, 0, 0.50 }, 0.005 ) );
	frame.add( board( { 0.085, -0.035, 0 }, { w - 0.085, 0, 0.09 }, 0.005 ) );
	frame.add( board( { 0.085, -0.035, 0.41 }, { w - 0.085, 0, 0.50 }, 0.005 ) );
	const Mesh pane = board( { 0.080, -0.026, 0.085 }, { w - 0.080, -0.010, 0.415 }, 0.003 );
	const Mesh grip = handle( 0.46, false ).placed( at( 0.5 * w, -0.034, 0.455 ) );
	b.object( "oven_door",
	    { b.part( "oven_door.stl", frame, "steel" ), b.part( "oven_pane.stl", pane, "black_glass" ),
	        b.part( "oven_handle.stl", grip, "graphite" ) },
	    place * at( 0, -d, 0.150, 0.5 * pi - 0.06 ) );
	Mesh hob = roundedBox( { 0.56, 0.50, 0.012 }, 0.005, 2 ).placed( at( 0.30, -0.31, top + 0.006 ) );
	Mesh rings;
	for ( int i = 0; i < 4; ++i )
	{
		const Pose at_ = at( i & 1 ? 0.43 : 0.17, i & 2 ? -0.19 : -0.43, top + 0.0125 );
		for ( double r : { 0.050, 0.075, ( i == 0 || i == 3 ) ? 0.100 : 0.088 } )
			rings.add( tube( circle( r, 0, 36 ), 0.0016, 4, true ), at_ );
	}
	b.object( "hob", { b.part( "hob.obj", hob, "black_glass" ), b.part( "hob_rings.obj", rings, "grey" ) }, place );
}

void addAbove( Builder& b )
{
	// wall cupboards, bottom at 1.42, depth 0.34
	const double z0 = 1.42, z1 = 2.12, deep = 0.34, w = 0.60;
	Mesh body = carcass( w, 0, z1 - z0, deep );
	body.add( board( { thick, -deep + 0.02, 0.34 }, { w - thick, -0.01, 0.358 } ) );
	const int body_part = b.part( "wall_cupboard.obj", body, "carcass" );
	const int wide = b.part( "wall_door.stl", panel( w, z1 - z0 ), "front" ),
	          half = b.part( "wall_door_half.stl", panel( 0.5 * w, z1 - z0 ), "front" );
	const int grip_wide = b.part( "wall_handle.stl", doorHandle( w, z1 - z0, true, true ), "steel" );
	const int grip_left = b.part( "wall_handle_left.stl", doorHandle( 0.5 * w, z1 - z0, true, true ), "steel" );
	const int grip_right = b.part( "wall_handle_right.stl", doorHandle( 0.5 * w, z1 - z0, false, true ), "steel" );
	const double xs[3] = { 0.78, 2.18, 3.38 };
	for ( int i = 0; i < 3; ++i )
		b.object( fmt::format( "wall_cupboard_{}", i + 1 ), { body_part }, at( xs[i], 3.6, z0 ) );
	// the first one: door hinged at its right edge, open; the second: two closed doors; the third: hinged left, open
	b.object( "wall_door_1", { wide, grip_wide }, at( xs[0] + w, 3.6 - deep, z0, 0, 0, 1.45 ) * at( -w, 0, 0 ) );
	b.object( "wall_door_2", { half, grip_left }, at( xs[1], 3.6 - deep, z0 ) );
	b.object( "wall_door_3", { half, grip_right }, at( xs[1] + 0.5 * w, 3.6 - deep, z0 ) );
	b.object( "wall_door_4", { half, grip_left }, at( xs[2], 3.6 - deep, z0, 0, 0, -1.75 ) );
	b.object( "wall_door_5", { half, grip_right }, at( xs[2] + w, 3.6 - deep, z0, 0, 0, 1.75 ) * at( -0.5 * w, 0, 0 ) );
	Mesh hood = loft( { { 0, 0.299, 0.240, 0, 0, 16 }, { 0.004, 0.300, 0.241, 0, 0, 16 }, { 0.05, 0.300, 0.241, 0, 0, 16 },
	                      { 0.055, 0.297, 0.238, 0, 0, 16 }, { 0.26, 0.13, 0.125, 0, 0.11, 16 },
	                      { 0.30, 0.12, 0.12, 0, 0.115, 16 }, { 0.88, 0.12, 0.12, 0, 0.115, 16 } },
	    48 );
	b.object( "hood", { b.part( "hood.obj", hood, "steel" ) }, at( 3.08, 3.355, 1.60 ) );
	// window with mullion and sill above the sink
	Mesh frame;
	auto bar = [&frame]( double x0, double x1, double z_low, double z_high ) {
		frame.add( board( { x0, -0.045, z_low }, { x1, 0, z_high }, 0.006, 2 ) );
	};
	bar( 0, 0.05, 0.05, 0.90 );
	bar( 0.65, 0.70, 0.05, 0.90 );
	bar( 0, 0.70, 0.0, 0.05 );
	bar( 0, 0.70, 0.90, 0.95 );
	bar( 0.335, 0.365, 0.05, 0.90 );
	frame.add( board( { -0.04, -0.13, -0.022 }, { 0.74, 0, 0.003 }, 0.008, 2 ) );
	b.object( "window",
	    { b.part( "window_frame.stl", frame, "enamel" ),
	        b.part( "window_pane.stl", board( { 0.045, -0.012, 0.045 }, { 0.655, -0.004, 0.905 }, 0.002 ), "window" ) },
	    at( 1.43, 3.6, 1.45 ) * at( 0, 0, -0.28 + 0.15 ) );
}

void addCountertop( Builder& b )
{
	// oak boards as solid boxes, leaving out the basin: x 1.515 to 2.045, y 3.08 to 3.49
	b.solid( "countertop", { 0.78, 2.98, 0.86 }, { 1.525, 3.6, top }, "oak" );
	b.solid( { 2.035, 2.98, 0.86 }, { 3.98, 3.6, top }, "oak" );
	b.solid( { 1.525, 2.98, 0.86 }, { 2.035, 3.09, top }, "oak" );
	b.solid( { 1.525, 3.48, 0.86 }, { 2.035, 3.6, top }, "oak" );
	b.solid( "plinth", { 0.78, 3.08, 0 }, { 3.98, 3.6, 0.098 }, "plinth" );
}

void addSideboard( Builder& b )
{
	// its own frame: back at y = 0, turned so that the front looks to +x
	const double w = 1.40, d = 0.42, h = 0.82;
	const Pose place = at( 0.012, 0.42, 0, 0, 0, 0.5 * pi );
	Mesh body = carcass( w, 0.12, h - 0.03, d );
	body.add( board( { 0.5 * w - 0.009, -d + 0.02, 0.138 }, { 0.5 * w + 0.009, -0.01, h - 0.05 } ) );
	body.add( board( { -0.015, -d - 0.03, h - 0.03 }, { w + 0.015, 0, h }, 0.008, 2 ) );
	for ( int i = 0; i < 4; ++i )
		body.add( lathe( { { 0, 0 }, { 0.014, 0 }, { 0.022, 0.115 }, { 0.026, 0.121 }, { 0, 0.121 } }, 18 ),
		    at( i & 1 ? 0.07 : w - 0.07, i & 2 ? -0.07 : -d + 0.06, 0 ) );
	b.object( "sideboard", { b.part( "sideboard.obj", body, "walnut" ) }, place );
	const int door = b.part( "sideboard_door.stl", panel( 0.5 * w, h - 0.152 ), "linen" );
	Mesh knob = lathe(
	    smoothedProfile(
	        { { 0, -0.002 }, { 0.009, 0.0 }, { 0.008, 0.012 }, { 0.016, 0.022 }, { 0.013, 0.030 }, { 0, 0.031 } }, 3 ),
	    18 )
	                .placed( at( 0, 0, 0, 0.5 * pi ) );
	const int knob_part = b.part( "sideboard_knob.stl", knob, "steel" );
	for ( int i = 0; i < 2; ++i )
	{
		const Pose p = place * at( 0.5 * w * i, -d, 0.121 );
		b.object( i ? "sideboard_door_right" : "sideboard_door_left", { door }, p )
		    .shapes.push_back( { knob_part, "", {}, "", p * at( i ? 0.045 : 0.5 * w - 0.045, -0.021, 0.45 ) } );
	}
	Mesh shelf = board( { 0, -0.22, 0 }, { 1.1, 0, 0.026 }, 0.006, 2 );
	for ( double x : { 0.12, 0.98 } )
		shelf.add(
		    tube( rounded( { { x, -0.006, -0.16 }, { x, -0.006, -0.004 }, { x, -0.20, -0.004 } }, 0.03, 5 ), 0.007, 10 ) );
	b.object( "wall_shelf", { b.part( "wall_shelf.stl", shelf, "walnut" ) }, at( 0.002, 0.57, 1.38, 0, 0, 0.5 * pi ) );
	Mesh clock = lathe( { { 0, 0 }, { 0.130, 0 }, { 0.138, 0.008 }, { 0.138, 0.030 }, { 0.130, 0.036 }, { 0.124, 0.030 },
	                        { 0.122, 0.018 }, { 0, 0.018 } },
	    44 );
	Mesh hands = board( { -0.004, -0.015, 0.0185 }, { 0.004, 0.070, 0.0215 }, 0.001 );
	hands.add( board( { -0.0035, -0.015, 0.022 }, { 0.0035, 0.100, 0.025 }, 0.001 ).placed( at( 0, 0, 0, 0, 0, -2.1 ) ) );
	for ( int i = 0; i < 12; ++i )
		hands.add(
		    board( { -0.003, 0.098, 0.0182 }, { 0.003, 0.114, 0.0205 }, 0.0008 ).placed( at( 0, 0, 0, 0, 0, pi / 6 * i ) ) );
	b.object( "clock", { b.part( "clock.obj", clock, "porcelain" ), b.part( "clock_hands.stl", hands, "graphite" ) },
	    at( 0.001, 1.15, 1.98 ) * at( 0, 0, 0, 0.5 * pi, 0, 0.5 * pi ) );
}

const Vec3 tableCentre = { 2.75, 1.02, 0.74 }; ///< middle of the table top's upper side

void addTable( Builder& b )
{
	Mesh topBoard = roundedBox( { 1.40, 0.80, 0.032 }, 0.010, 3 ).placed( at( 0, 0, -0.016 ) );
	Mesh legs;
	const Mesh leg =
	    lathe( smoothedProfile( { { 0, -0.740 }, { 0.017, -0.740 }, { 0.020, -0.730 }, { 0.022, -0.60 }, { 0.028, -0.40 },
	                                { 0.036, -0.22 }, { 0.024, -0.165 }, { 0.036, -0.14 }, { 0.038, -0.04 }, { 0, -0.035 } },
	               3 ),
	        20 );
	for ( int i = 0; i < 4; ++i )
		legs.add( leg, at( i & 1 ? 0.63 : -0.63, i & 2 ? 0.34 : -0.34, 0 ) );
	for ( int side = -1; side <= 1; side += 2 )
	{
		legs.add( board( { -0.60, side * 0.34 - 0.011, -0.12 }, { 0.60, side * 0.34 + 0.011, -0.034 } ) );
		legs.add( board( { side * 0.63 - 0.011, -0.31, -0.12 }, { side * 0.63 + 0.011, 0.31, -0.034 } ) );
	}
	b.object( "table", { b.part( "table_top.stl", topBoard, "oak" ), b.part( "table_legs.obj", legs, "walnut" ) },
	    at( tableCentre.x, tableCentre.y, tableCentre.z ) );
	// chair: looks to +x, seat 0.45
	Mesh seat =
	    loft( domed( { { 0.432, 0.205, 0.200, 0, 0, 4.5 }, { 0.448, 0.212, 0.205, 0, 0, 4.5 } }, 0.004, 0.008, 3 ), 40 );
	Mesh frame;
	const Mesh chairLeg = lathe( smoothedProfile( { { 0, 0 }, { 0.011, 0 }, { 0.013, 0.006 }, { 0.016, 0.18 },
	                                                  { 0.020, 0.30 }, { 0.015, 0.43 }, { 0, 0.435 } },
	                                 2 ),
	    14 );
	for ( int i = 0; i < 4; ++i )
	{
		const double x = i & 1 ? 0.165 : -0.165, y = i & 2 ? 0.16 : -0.16;
		frame.add( chairLeg, at( x, y, 0 ) );
	}
	for ( int side = -1; side <= 1; side += 2 )
	{
		frame.add( tube( { { -0.165, 0.16 * side, 0.20 }, { 0.165, 0.16 * side, 0.20 } }, 0.009, 12 ) );
		frame.add( tube(
		    rounded( { { -0.172, 0.165 * side, 0.43 }, { -0.195, 0.168 * side, 0.62 }, { -0.245, 0.168 * side, 0.90 } },
		        0.10, 5 ),
		    0.0135, 14 ) );
	}
	for ( int i = 0; i < 5; ++i ) // spindles
		frame.add( tube( { { -0.180, -0.108 + 0.054 * i, 0.44 }, { -0.205, -0.114 + 0.057 * i, 0.64 },
		                     { -0.238, -0.116 + 0.058 * i, 0.86 } },
		    0.0075, 8 ) );
	const Mesh rail = loft( domed( { { -0.185, 0.012, 0.040, 0, 0, 3 }, { -0.09, 0.013, 0.046, -0.010, 0, 3 },
	                                   { 0.09, 0.013, 0.046, -0.010, 0, 3 }, { 0.185, 0.012, 0.040, 0, 0, 3 } },
	                            0.008, 0.008, 3 ),
	    20 );
	frame.add( rail, at( -0.240, 0, 0.885, 0.5 * pi, -0.15 ) );
	const int seat_part = b.part( "chair_seat.stl", seat, "front" ),
	          frame_part = b.part( "chair_frame.obj", frame, "walnut" );
	const double cx = tableCentre.x, cy = tableCentre.y;
	b.object( "chair_1", { seat_part, frame_part }, at( cx - 0.36, cy - 0.56, 0, 0, 0, 0.5 * pi ) );
	b.object( "chair_2", { seat_part, frame_part }, at( cx + 0.34, cy - 0.62, 0, 0, 0, 0.5 * pi + 0.15 ) );
	b.object( "chair_3", { seat_part, frame_part }, at( cx - 0.90, cy + 0.03, 0, 0, 0, 0.05 ) );
	b.object( "chair_4", { seat_part, frame_part }, at( cx + 0.98, cy - 0.02, 0, 0, 0, pi - 0.20 ) );
}

/// The things that lie and stand about: their parts, each once, and their places.
class Things
{
public:
	explicit Things( Builder& builder ) : m_b( builder ) {}

	void add()
	{
		layTable();
		fillCounterLeft();
		fillSink();
		fillHob();
		fillFridge();
		fillDrawer();
		fillCupboards();
		fillSideboard();
		addCylinders();
	}

private:
	void layTable();
	void fillCounterLeft();
	void fillSink();
	void fillHob();
	void fillFridge();
	void fillDrawer();
	void fillCupboards();
	void fillSideboard();
	void addCylinders();
	void stand( const std::string& name, const std::vector<int>& parts, double x, double y, double z, double yaw = 0 )
	{
		m_b.object( fmt::format( "{}_{}", name, ++m_counter ), parts, at( x, y, z, 0, 0, yaw ) );
	}

	Builder& m_b;
	const double t = tableCentre.z + 0.001, c = top + 0.001; ///< heights of table and counter, and a gap
	int m_counter = 0;
	const int plate = m_b.part( "plate.obj", makePlate(), "porcelain" ),
	          blue_plate = m_b.part( "plate_blue.obj", makePlate(), "blue_glaze" );
	const int cup = m_b.part( "cup.obj", makeCup(), "porcelain" ),
	          red_cup = m_b.part( "cup_red.obj", makeCup(), "red_glaze" );
	const int glass = m_b.part( "glass.obj", makeGlass(), "window" ),
	          wine = m_b.part( "bottle_wine.obj", makeWineBottle(), "green_glass" );
	const int milk = m_b.part( "bottle_milk.obj", makeMilkBottle(), "milk" ), jar = m_b.part( "jar.obj", makeJar(), "jam" );
	const int lid = m_b.part( "jar_lid.obj", makeJarLid(), "yellow" ), pan = m_b.part( "pan.obj", makePan(), "iron" ),
	          copper_pan = m_b.part( "pan_copper.obj", makePan(), "copper" );
	const int pot = m_b.part( "pot.obj", makePot(), "steel" ), pot_lid = m_b.part( "pot_lid.obj", makePotLid(), "steel" ),
	          kettle = m_b.part( "kettle.obj", makeKettle(), "red_glaze" );
	const int bowl = m_b.part( "bowl.obj", makeBowl( 0.14, 0.085 ), "blue_glaze" ),
	          small_bowl = m_b.part( "bowl_small.obj", makeBowl( 0.075, 0.055 ), "yellow" );
	const int apple = m_b.part( "apple.obj", makeFruit( 0.037, 0.92 ), "apple" ),
	          pear = m_b.part( "pear.obj", makeFruit( 0.034, 1.12 ), "pear" ),
	          orange = m_b.part( "orange.obj", makeFruit( 0.038, 0.98 ), "orange" );
	const int spoon = m_b.part( "spoon.stl", makeSpoon(), "steel" ), fork = m_b.part( "fork.stl", makeFork(), "steel" ),
	          knife = m_b.part( "knife.stl", makeKnife(), "steel" );
	const int leaves = m_b.part( "leaves.obj", makeLeaves(), "leaf" ),
	          plant_pot = m_b.part( "plant_pot.obj", makePlantPot(), "terracotta" );
	const int bread = m_b.part( "bread.obj", makeBread(), "bread" ),
	          loaf_board =
	              m_b.part( "cutting_board.stl", board( { -0.17, -0.11, 0 }, { 0.17, 0.11, 0.018 }, 0.006, 2 ), "walnut" );
};

/// Table: four covers, a bowl of fruit, bottle and glasses.
void Things::layTable()
{
	const double covers[4][3] = {
	    { -0.36, -0.24, 0 }, { 0.36, -0.24, 0 }, { -0.52, 0.06, -0.5 * pi }, { 0.52, 0.02, 0.5 * pi } };
	for ( auto& cover : covers )
	{
		const Pose p = at( tableCentre.x + cover[0], tableCentre.y + cover[1], t, 0, 0, cover[2] );
		m_b.object( fmt::format( "cover_{}", ++m_counter ), { plate }, p );
		auto beside = [&]( int part, double x, double y, double yaw ) {
			m_b.room.objects.back().shapes.push_back( { part, "", {}, "", p * at( x, y, 0, 0, 0, yaw ) } );
		};
		beside( fork, -0.165, 0.05, -0.5 * pi );
		beside( knife, 0.160, -0.04, 0.5 * pi );
		beside( spoon, 0.185, 0.04, -0.5 * pi );
	}
	stand( "glass", { glass }, 2.60, 0.96, t );
	stand( "glass", { glass }, 2.93, 1.00, t );
	stand( "wine", { wine }, 2.86, 1.14, t );
	stand( "fruit_bowl", { bowl }, 2.70, 1.18, t );
	const double fruit[5][3] = {
	    { 0.0, 0.0, 0 }, { 0.062, 0.030, 1 }, { -0.055, 0.045, 2 }, { -0.020, -0.068, 0 }, { 0.055, -0.050, 2 } };
	for ( auto& f : fruit )
		stand( "fruit",
		    { f[2] == 0     ? apple
		        : f[2] == 1 ? pear
		                    : orange },
		    2.70 + f[0], 1.18 + f[1], t + 0.024 + 0.012 * ( f[0] != 0 ), 2 * f[1] );
	stand( "cup", { red_cup }, 3.08, 1.23, t, 0.8 );
	stand( "cup", { cup }, 2.42, 1.26, t, 2.2 );
	stand( "jar", { jar, lid }, 2.98, 1.24, t );
}

/// Counter left, under the wall cupboard.
void Things::fillCounterLeft()
{
	stand( "bread_board", { loaf_board }, 1.03, 3.22, c, 0.15 );
	stand( "bread", { bread }, 1.03, 3.22, c + 0.019, 0.15 );
	for ( int i = 0; i < 3; ++i )
		stand( "jar", { jar, lid }, 0.86 + 0.105 * i, 3.51, c );
	stand( "utensils",
	    { m_b.part( "utensil_jar.obj", makeUtensilJar(), "terracotta" ), m_b.part( "utensils.obj", makeUtensils(), "oak" ) },
	    1.31, 3.48, c );
}

/// Sink: plates in the basin, a rack beside.
void Things::fillSink()
{
	stand( "sink_plate", { blue_plate }, 1.72, 3.27, top - 0.180 );
	stand( "sink_bowl", { small_bowl }, 1.93, 3.36, top - 0.178 );
	stand( "dish_rack", { m_b.part( "dish_rack.obj", makeDishRack(), "steel" ) }, 2.30, 3.33, c, 0.5 * pi );
	for ( int i = 0; i < 4; ++i )
		m_b.object( fmt::format( "rack_plate_{}", i + 1 ), { i % 2 ? blue_plate : plate },
		    at( 2.30, 3.24 + 0.07 * i - 0.003, c + 0.165, 0.5 * pi + 0.02 ) );
	stand( "rack_cup", { cup }, 2.55, 3.30, c, 0.6 );
	stand( "rack_cup", { red_cup }, 2.58, 3.45, c, -0.6 );
}

/// Hob and counter right.
void Things::fillHob()
{
	stand( "pan", { pan }, 3.21, 3.17, top + 0.0145, -1.15 );
	stand( "pot", { pot, pot_lid }, 2.95, 3.41, top + 0.0145, 0.1 );
	stand( "pot", { pot }, 3.21, 3.41, top + 0.0145, 0.1 );
	stand( "kettle", { kettle }, 3.56, 3.42, c, 2.6 );
	stand( "bowl", { bowl }, 3.68, 3.16, c );
	stand( "wine", { wine }, 3.76, 3.47, c );
	stand( "wine", { wine }, 3.87, 3.44, c );
	stand( "milk", { milk }, 3.89, 3.27, c );
}

/// Fridge: shelves at 0.40, 0.80, 1.20, 1.50 (+ 0.008 glass, 0.001 gap).
void Things::fillFridge()
{
	const double fx = 0.12, fy = 3.59;
	stand( "fridge_milk", { milk }, fx + 0.13, fy - 0.20, 1.2100 );
	stand( "fridge_milk", { milk }, fx + 0.25, fy - 0.15, 1.2100 );
	stand( "fridge_jar", { jar, lid }, fx + 0.53, fy - 0.16, 1.2100 );
	stand( "fridge_bowl", { small_bowl }, fx + 0.20, fy - 0.25, 1.5100 );
	stand( "fridge_jar", { jar, lid }, fx + 0.46, fy - 0.22, 1.5100 );
	stand( "fridge_wine", { wine }, fx + 0.12, fy - 0.16, 0.8100 );
	stand( "fridge_pot", { pot, pot_lid }, fx + 0.42, fy - 0.25, 0.8100, 1.57 );
	stand( "fridge_bowl", { bowl }, fx + 0.30, fy - 0.28, 0.4100 );
	const Pose hinge = at( fx, fy - 0.624, 0, 0, 0, -1.60 );
	const double racks[5][2] = { { 0.15, 1.512 }, { 0.27, 1.512 }, { 0.18, 0.713 }, { 0.32, 0.713 }, { 0.45, 0.713 } };
	for ( int i = 0; i < 5; ++i )
		m_b.object( fmt::format( "door_bottle_{}", i + 1 ),
		    i < 2 ? std::vector<int>{ jar, lid } : std::vector<int>{ i == 3 ? wine : milk },
		    hinge * at( racks[i][0], 0.046, racks[i][1] ) );
}

/// Drawer (open by 0.34): cutlery.
void Things::fillDrawer()
{
	for ( int i = 0; i < 9; ++i )
		m_b.object( fmt::format( "drawer_cutlery_{}", i + 1 ),
		    { i < 3     ? spoon
		        : i < 6 ? fork
		                : knife },
		    at( 0.86 + 0.05 * i, 2.86, 0.7235, 0, 0, 0.5 * pi ) );
}

/// Cupboard, open: pots and pans; oven: a loaf in a dish; wall cupboards: plates and cups.
void Things::fillCupboards()
{
	stand( "cupboard_pot", { pot, pot_lid }, 2.35, 3.33, 0.479, 1.57 );
	stand( "cupboard_pan", { copper_pan }, 2.58, 3.33, 0.479, 1.9 );
	stand( "cupboard_bowl", { bowl }, 2.36, 3.32, 0.119 );
	stand( "cupboard_bowl", { bowl }, 2.36, 3.32, 0.145 );
	stand( "oven_dish", { copper_pan }, 3.12, 3.36, 0.256, 2.8 );
	stand( "oven_bread", { bread }, 3.12, 3.36, 0.266, 0.3 );
	for ( int i = 0; i < 5; ++i )
		stand( "stacked_plate", { i % 2 ? blue_plate : plate }, 3.55, 3.43, 1.439 + 0.009 * i );
	for ( int i = 0; i < 3; ++i )
		stand( "wall_cup", { i % 2 ? red_cup : cup }, 3.50 + 0.15 * i, 3.44, 1.779, 2.0 + i );
	for ( int i = 0; i < 4; ++i )
		stand( "wall_glass", { glass }, 0.87 + 0.12 * i, 3.44, 1.439 );
	for ( int i = 0; i < 3; ++i )
		stand( "wall_bowl", { small_bowl }, 1.00, 3.44, 1.779 + 0.018 * i );
	stand( "wall_jar", { jar, lid }, 1.22, 3.44, 1.779 );
}

/// Sideboard and shelf.
void Things::fillSideboard()
{
	m_b.object( "table_lamp",
	    { m_b.part( "lamp_foot.obj", makeTableLamp(), "terracotta" ),
	        m_b.part( "lamp_shade.obj", makeLampShade(), "linen" ) },
	    at( 0.21, 0.66, 0.821 ) );
	stand( "fruit_bowl", { bowl }, 0.22, 1.12, 0.821 );
	for ( int i = 0; i < 3; ++i )
		stand( "fruit", { orange }, 0.22 + 0.045 * ( i - 1 ), 1.12 + ( i == 1 ? 0.05 : -0.03 ), 0.821 + 0.026 );
	stand( "plant", { plant_pot, leaves }, 0.20, 1.56, 0.821 );
	stand( "plant", { plant_pot, leaves }, 0.115, 1.52, 1.407, 1.0 );
	for ( int i = 0; i < 4; ++i )
		stand( "shelf_cup", { i % 2 ? cup : red_cup }, 0.115, 0.72 + 0.13 * i, 1.407, 0.4 * i );
	stand( "shelf_jar", { jar, lid }, 0.115, 1.26, 1.407 );
	stand( "plant", { plant_pot, leaves }, 1.55, 3.535, 1.324, 0.5 );
	m_b.object( "pendant_lamp", { m_b.part( "pendant.obj", makePendant(), "yellow" ) }, at( 2.75, 1.02, 1.95 ) );
}

/// Rolling pin and a post of a coat rack: solid cylinders.
void Things::addCylinders()
{
	m_b.object( "rolling_pin", {} );
	m_b.cylinder( 0.26, 0.024, "oak", at( 3.52, 3.10, c + 0.0245, 0, 0.5 * pi, 0 ) * at( 0, 0, 0 ) );
	m_b.cylinder( 0.40, 0.010, "walnut", at( 3.52, 3.10, c + 0.0245, 0, 0.5 * pi, 0 ) );
	m_b.object( "bin", {} );
	m_b.cylinder( 0.44, 0.14, "steel", at( 0.20, 2.08, 0.22 ) );
	m_b.cylinder( 0.03, 0.145, "graphite", at( 0.20, 2.08, 0.455 ) );
}

} // namespace

Room makeRoom()
{
	Builder b;
	addShell( b );
	addFridge( b );
	addDrawers( b, at( 0.78, 3.6, 0 ) );
	addSink( b, at( 1.38, 3.6, 0 ) );
	addCupboard( b, at( 2.18, 3.6, 0 ) );
	addOven( b, at( 2.78, 3.6, 0 ) );
	addCountertop( b );
	addAbove( b );
	addSideboard( b );
	addTable( b );
	Things( b ).add();
	return b.room;
}

} // namespace kitchen
