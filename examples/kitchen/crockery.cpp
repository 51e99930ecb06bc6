// SPDX-License-Identifier: BSD-3-Clause
// Plates, cups with handles, pans, bottles, fruit: lathed profiles, lofts and pipes.
#include "crockery.hpp"

#include <cmath>

namespace kitchen
{

Mesh makePlate()
{
	return lathe( smoothedProfile(
	                  { { 0, 0.002 }, { 0.055, 0.002 }, { 0.062, 0.0 }, { 0.068, 0.002 }, { 0.095, 0.010 }, { 0.128, 0.019 },
	                      { 0.131, 0.0215 }, { 0.128, 0.023 }, { 0.094, 0.0145 }, { 0.070, 0.007 }, { 0, 0.006 } },
	                  1 ),
	    40 );
}

Mesh makeBowl( double radius, double height )
{
	const double r = radius, h = height, w = 0.004;
	return lathe( smoothedProfile( { { 0, 0.004 }, { 0.40 * r, 0.003 }, { 0.44 * r, 0 }, { 0.48 * r, 0.004 },
	                                   { 0.78 * r, 0.32 * h }, { 0.95 * r, 0.72 * h }, { r, h - 0.002 }, { r - 0.5 * w, h },
	                                   { r - w, h - 0.002 }, { 0.95 * r - w, 0.72 * h }, { 0.77 * r - w, 0.34 * h },
	                                   { 0.42 * r, 0.09 * h + 0.004 }, { 0, 0.06 * h + 0.004 } },
	                  1 ),
	    36 );
}

Mesh makeCup()
{
	Mesh cup = lathe( smoothedProfile( { { 0, 0.003 }, { 0.025, 0.002 }, { 0.029, 0 }, { 0.033, 0.004 }, { 0.038, 0.030 },
	                                       { 0.041, 0.070 }, { 0.0425, 0.094 }, { 0.0410, 0.096 }, { 0.0395, 0.094 },
	                                       { 0.038, 0.070 }, { 0.035, 0.030 }, { 0.029, 0.008 }, { 0, 0.006 } },
	                      1 ),
	    28 );
	std::vector<Vec3> ear = { { 0.0375, 0, 0.078 }, { 0.056, 0, 0.081 }, { 0.069, 0, 0.066 }, { 0.069, 0, 0.045 },
	    { 0.056, 0, 0.026 }, { 0.0365, 0, 0.024 } };
	return cup.add( tube( rounded( ear, 0.009, 2 ), 0.0048, 8 ) );
}

Mesh makeGlass()
{
	return lathe( smoothedProfile( { { 0, 0.001 }, { 0.026, 0.0 }, { 0.029, 0.004 }, { 0.032, 0.06 }, { 0.034, 0.118 },
	                                   { 0.033, 0.120 }, { 0.032, 0.118 }, { 0.030, 0.06 }, { 0.027, 0.012 }, { 0, 0.010 } },
	                  1 ),
	    28 );
}

Mesh makeWineBottle()
{
	return lathe( smoothedProfile( { { 0, 0.012 }, { 0.022, 0.006 }, { 0.033, 0 }, { 0.037, 0.006 }, { 0.0375, 0.08 },
	                                   { 0.0375, 0.185 }, { 0.031, 0.215 }, { 0.0165, 0.238 }, { 0.0145, 0.285 },
	                                   { 0.0165, 0.288 }, { 0.0165, 0.300 }, { 0.013, 0.303 }, { 0, 0.303 } },
	                  1 ),
	    32 );
}

Mesh makeMilkBottle()
{
	return lathe( smoothedProfile( { { 0, 0.004 }, { 0.030, 0.002 }, { 0.038, 0.0 }, { 0.042, 0.006 }, { 0.042, 0.06 },
	                                   { 0.042, 0.125 }, { 0.034, 0.155 }, { 0.021, 0.178 }, { 0.020, 0.198 },
	                                   { 0.0245, 0.200 }, { 0.0245, 0.218 }, { 0.021, 0.221 }, { 0, 0.221 } },
	                  1 ),
	    30 );
}

Mesh makeJar()
{
	return lathe( smoothedProfile( { { 0, 0.003 }, { 0.035, 0.0 }, { 0.041, 0.006 }, { 0.042, 0.05 }, { 0.041, 0.100 },
	                                   { 0.036, 0.112 }, { 0.036, 0.120 }, { 0, 0.120 } },
	                  2 ),
	    28 );
}

Mesh makeJarLid()
{
	return drum( 0.039, 0.121, 0.140, 0.003, 28 );
}

Mesh makePan()
{
	Mesh pan = lathe( smoothedProfile( { { 0, 0.0 }, { 0.095, 0.0 }, { 0.103, 0.003 }, { 0.116, 0.025 }, { 0.125, 0.047 },
	                                       { 0.127, 0.049 }, { 0.124, 0.049 }, { 0.114, 0.027 }, { 0.101, 0.006 },
	                                       { 0.092, 0.004 }, { 0, 0.004 } },
	                      2 ),
	    40 );
	const Mesh grip = loft( domed( smoothed( { { 0.05, 0.009, 0.006, 0, 0, 2.2 }, { 0.10, 0.011, 0.008, 0, 0, 2.2 },
	                                             { 0.185, 0.013, 0.009, 0, 0, 2.2 } },
	                                   3 ),
	                            0.004, 0.012, 3 ),
	    14 );
	pan.add( grip, at( 0.085, 0, 0.035, 0, 0.5 * pi - 0.22 ) );
	return pan.add( tube( { { 0.118, 0, 0.041 }, { 0.150, 0, 0.0475 } }, 0.0055, 10 ) );
}

Mesh makePot()
{
	Mesh pot =
	    lathe( { { 0, 0.0 }, { 0.088, 0.0 }, { 0.096, 0.003 }, { 0.100, 0.010 }, { 0.100, 0.125 }, { 0.103, 0.128 },
	               { 0.103, 0.131 }, { 0.0985, 0.132 }, { 0.097, 0.129 }, { 0.097, 0.010 }, { 0.092, 0.005 }, { 0, 0.004 } },
	        40 );
	for ( int side = -1; side <= 1; side += 2 )
	{
		const double s = side;
		const std::vector<Vec3> ear = { { 0.098 * s, -0.034, 0.105 }, { 0.138 * s, -0.034, 0.110 },
		    { 0.138 * s, 0.034, 0.110 }, { 0.098 * s, 0.034, 0.105 } };
		pot.add( tube( rounded( ear, 0.018, 4 ), 0.0055, 10 ) );
	}
	return pot;
}

Mesh makePotLid()
{
	return lathe(
	    smoothedProfile( { { 0, 0.1325 }, { 0.098, 0.1325 }, { 0.102, 0.1345 }, { 0.098, 0.138 }, { 0.055, 0.150 },
	                         { 0.012, 0.154 }, { 0.008, 0.160 }, { 0.018, 0.170 }, { 0.016, 0.177 }, { 0, 0.179 } },
	        2 ),
	    36 );
}

Mesh makeKettle()
{
	Mesh kettle = lathe( smoothedProfile( { { 0, 0.0 }, { 0.078, 0.0 }, { 0.086, 0.006 }, { 0.086, 0.05 }, { 0.074, 0.115 },
	                                          { 0.058, 0.165 }, { 0.050, 0.182 }, { 0.030, 0.190 }, { 0.010, 0.193 },
	                                          { 0.010, 0.203 }, { 0.014, 0.210 }, { 0, 0.214 } },
	                         2 ),
	    36 );
	const Mesh spout = loft( smoothed( { { 0, 0.022, 0.020 }, { 0.05, 0.017, 0.014 }, { 0.10, 0.011, 0.009 } }, 3 ), 14 );
	kettle.add( spout, at( -0.062, 0, 0.10, 0, -0.75 ) );
	const std::vector<Vec3> ear = {
	    { 0.050, 0, 0.172 }, { 0.110, 0, 0.190 }, { 0.128, 0, 0.120 }, { 0.118, 0, 0.050 }, { 0.083, 0, 0.040 } };
	return kettle.add( tube( rounded( ear, 0.022, 4 ), 0.009, 12 ) );
}

Mesh makeFruit( double radius, double squash )
{
	std::vector<std::array<double, 2>> profile;
	const int rings = 12;
	for ( int i = 0; i <= rings; ++i )
	{
		// a small dimple at both ends
		const double a = pi * i / rings, dimple = 1 - 0.14 * std::pow( std::fabs( std::cos( a ) ), 8 );
		profile.push_back(
		    { i == 0 || i == rings ? 0 : radius * std::sin( a ), radius * squash * ( 1 - dimple * std::cos( a ) ) } );
	}
	Mesh fruit = lathe( profile, 18 );
	return fruit.add( tube( { { 0, 0, 1.84 * squash * radius }, { 0.003, 0, 2.16 * squash * radius } }, 0.0016, 6 ) );
}

static Mesh cutleryHandle( double from, double to )
{
	return loft(
	    domed( { { from, 0.0030, 0.0018 }, { 0.5 * ( from + to ), 0.0042, 0.0020 }, { to, 0.0075, 0.0020 } }, 0, 0.006, 2 ),
	    10 )
	    .placed( at( 0, 0, 0.004, 0, 0.5 * pi ) );
}

Mesh makeSpoon()
{
	Mesh spoon = cutleryHandle( 0, 0.11 );
	const Mesh head = loft( domed( smoothed( { { 0, 0.0045, 0.0022 }, { 0.02, 0.0175, 0.0034, 0, 0.002 },
	                                             { 0.042, 0.017, 0.0032, 0, 0.002 }, { 0.055, 0.009, 0.0025 } },
	                                   2 ),
	                            0.002, 0.004, 2 ),
	    12 );
	return spoon.add( head, at( 0.004, 0, 0.004, 0, -0.5 * pi ) * at( 0, 0, 0, 0, 0, 0.5 * pi ) );
}

Mesh makeFork()
{
	Mesh fork = cutleryHandle( 0, 0.12 );
	fork.add( board( { -0.026, -0.0115, 0.0025 }, { 0.004, 0.0115, 0.0055 }, 0.0012 ) );
	for ( int i = 0; i < 4; ++i )
		fork.add( board( { -0.066, -0.0110 + 0.0063 * i, 0.0028 }, { -0.024, -0.0078 + 0.0063 * i, 0.0052 }, 0.0008 ) );
	return fork;
}

Mesh makeKnife()
{
	Mesh knife = cutleryHandle( 0, 0.10 );
	return knife.add( loft( domed( { { 0, 0.0012, 0.0075 }, { 0.08, 0.0012, 0.0095 }, { 0.105, 0.0010, 0.007, 0, 0.003 } },
	                            0.001, 0.010, 3 ),
	                      10 ),
	    at( 0.002, 0, 0.0095, 0, -0.5 * pi, 0 ) * at( 0, 0, 0, 0, 0, 0.5 * pi ) );
}

Mesh makePlantPot()
{
	return lathe( { { 0, 0 }, { 0.043, 0 }, { 0.046, 0.003 }, { 0.058, 0.090 }, { 0.063, 0.090 }, { 0.065, 0.093 },
	                  { 0.066, 0.118 }, { 0.063, 0.120 }, { 0.060, 0.118 }, { 0.057, 0.106 }, { 0, 0.104 } },
	    30 );
}

Mesh makeLeaves()
{
	Mesh leaves;
	const Mesh leaf = loft( domed( smoothed( { { 0, 0.003, 0.002 }, { 0.05, 0.016, 0.003, 0, 0.006 },
	                                             { 0.11, 0.020, 0.003, 0, -0.004 }, { 0.16, 0.009, 0.002, 0, -0.026 } },
	                                   2 ),
	                            0.002, 0.02, 2 ),
	    10 );
	for ( int i = 0; i < 11; ++i )
	{
		// golden angle, inner leaves steeper
		const double yaw = 2.39996 * i, lean = 0.15 + 0.075 * i;
		leaves.add( leaf, at( 0.010 * std::cos( yaw ), 0.010 * std::sin( yaw ), 0.100, 0, 0, yaw ) *
		                      at( 0, 0, 0, 0, lean, 0 ) * at( 0, 0, 0, 0, 0, -0.5 * pi ) );
	}
	return leaves;
}

Mesh makePendant()
{
	Mesh shade = lathe( smoothedProfile( { { 0.020, 0.165 }, { 0.030, 0.163 }, { 0.062, 0.135 }, { 0.110, 0.070 },
	                                         { 0.158, 0.004 }, { 0.160, 0.0 }, { 0.156, 0.001 }, { 0.107, 0.068 },
	                                         { 0.060, 0.130 }, { 0.030, 0.156 }, { 0.018, 0.158 } },
	                        3 ),
	    40 );
	shade.add( lathe( { { 0, 0.15 }, { 0.024, 0.15 }, { 0.026, 0.155 }, { 0.022, 0.215 }, { 0.010, 0.235 }, { 0.0035, 0.24 },
	                      { 0.0035, 0.55 }, { 0, 0.55 } },
	    20 ) );
	return shade;
}

Mesh makeTableLamp()
{
	return lathe( smoothedProfile( { { 0, 0 }, { 0.066, 0 }, { 0.070, 0.005 }, { 0.060, 0.014 }, { 0.022, 0.028 },
	                                   { 0.014, 0.060 }, { 0.030, 0.120 }, { 0.036, 0.155 }, { 0.022, 0.200 },
	                                   { 0.009, 0.225 }, { 0.008, 0.290 }, { 0, 0.295 } },
	                  2 ),
	    32 );
}

Mesh makeLampShade()
{
	return lathe( { { 0.125, 0.215 }, { 0.128, 0.213 }, { 0.130, 0.216 }, { 0.088, 0.380 }, { 0.085, 0.382 },
	                  { 0.083, 0.378 }, { 0.125, 0.215 } },
	    40, false );
}

Mesh makeDishRack()
{
	// two frames of wire and a row of hoops between which plates stand
	Mesh rack;
	auto loop = []( double x, double y, double z )
	{
		return tube(
		    rounded( { { 0, -y, z }, { x, -y, z }, { x, y, z }, { -x, y, z }, { -x, -y, z }, { -0.001, -y, z } }, 0.025, 3 ),
		    0.0028, 7 );
	};
	rack.add( loop( 0.17, 0.13, 0.022 ) ).add( loop( 0.18, 0.14, 0.105 ) );
	for ( int i = 0; i < 9; ++i )
	{
		const double x = -0.14 + 0.035 * i;
		rack.add( tube(
		    rounded( { { x, -0.14, 0.105 }, { x, -0.13, 0.022 }, { x, 0, 0.022 }, { x, 0.13, 0.022 }, { x, 0.14, 0.105 } },
		        0.012, 2 ),
		    0.0022, 7 ) );
	}
	for ( int i = 0; i < 4; ++i )
		rack.add( drum( 0.007, 0, 0.022, 0.002, 10 ), at( i & 1 ? 0.15 : -0.15, i & 2 ? 0.11 : -0.11, 0 ) );
	return rack;
}

Mesh makeBread()
{
	return loft( domed( smoothed( { { -0.10, 0.046, 0.052, 0.046, 0, 2.3 }, { -0.04, 0.054, 0.061, 0.054, 0, 2.4 },
	                                  { 0.04, 0.055, 0.062, 0.055, 0, 2.4 }, { 0.10, 0.046, 0.053, 0.046, 0, 2.3 } },
	                        3 ),
	                 0.028, 0.028, 4 ),
	    24 )
	    .placed( at( 0, 0, 0, 0, -0.5 * pi ) * at( 0, 0, 0, 0, 0, 0 ) );
}

Mesh makeUtensilJar()
{
	return lathe( { { 0, 0.004 }, { 0.040, 0 }, { 0.047, 0.004 }, { 0.050, 0.075 }, { 0.050, 0.145 }, { 0.048, 0.148 },
	                  { 0.045, 0.145 }, { 0.045, 0.075 }, { 0.042, 0.010 }, { 0, 0.010 } },
	    30 );
}

Mesh makeUtensils()
{
	Mesh all;
	const double yaw[5] = { 0.2, 1.5, 2.7, 3.9, 5.2 }, lean[5] = { 0.13, 0.17, 0.11, 0.16, 0.14 };
	for ( int i = 0; i < 5; ++i )
	{
		Mesh tool = lathe( { { 0, 0.0 }, { 0.005, 0.002 }, { 0.0045, 0.21 }, { 0, 0.214 } }, 10 );
		if ( i % 2 )
			tool.add( loft(
			    domed( { { 0.215, 0.013, 0.004, 0, 0, 2.5 }, { 0.270, 0.027, 0.003, 0, 0, 3 } }, 0.02, 0.006, 3 ), 14 ) );
		else
			tool.add( loft( domed( { { 0.225, 0.018, 0.006 }, { 0.250, 0.022, 0.007 } }, 0.02, 0.022, 3 ), 14 ) );
		all.add( tool, at( 0.012 * std::cos( yaw[i] ), 0.012 * std::sin( yaw[i] ), 0.014, 0, 0, yaw[i] ) *
		                   at( 0, 0, 0, 0, lean[i], 0 ) );
	}
	return all;
}

} // namespace kitchen
