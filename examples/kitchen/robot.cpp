// SPDX-License-Identifier: BSD-3-Clause
// A humanoid of 23 degrees of freedom on a wheeled base, in the proportions of ARMAR (Steinbach et al. 2006): base 3, torso
// 3, head 3, arms 2 x 7. x is forward, y left, z up; arms hang down at zero and every mesh is in its link's frame.
#include "model.hpp"

#include <stdexcept>

namespace kitchen
{

namespace
{

// y-axis body: a lathe profile about z turned so that its z points along +y
const Pose alongY = at( 0, 0, 0, -0.5 * pi );
// turned so that z points along +x
const Pose alongX = at( 0, 0, 0, 0, 0.5 * pi );

Link makeBase()
{
	Mesh shell = loft(
	    smoothed( { { 0.055, 0.285, 0.255, 0, 0, 3.2 }, { 0.075, 0.298, 0.268, 0, 0, 3.2 }, { 0.16, 0.30, 0.27, 0, 0, 3.2 },
	                  { 0.30, 0.288, 0.258, 0, 0, 3 }, { 0.375, 0.25, 0.225, -0.005, 0, 2.7 },
	                  { 0.405, 0.19, 0.18, -0.01, 0, 2.4 }, { 0.42, 0.13, 0.125, -0.01, 0, 2.1 } },
	        2 ),
	    36 );
	Mesh dark = loft( { { 0.095, 0.297, 0.267, 0, 0, 3.2 }, { 0.10, 0.308, 0.278, 0, 0, 3.2 },
	                      { 0.14, 0.309, 0.279, 0, 0, 3.2 }, { 0.145, 0.299, 0.269, 0, 0, 3.2 } },
	    36, false ); // bumper
	const Mesh wheel = lathe(
	    { { 0, -0.018 }, { 0.050, -0.016 }, { 0.056, -0.010 }, { 0.056, 0.010 }, { 0.050, 0.016 }, { 0, 0.018 } }, 14 );
	for ( int i = 0; i < 4; ++i )
		dark.add( wheel, at( i & 1 ? 0.17 : -0.17, i & 2 ? 0.17 : -0.17, 0.0565 ) * alongY );
	dark.add( drum( 0.045, 0, 0.045, 0.006, 24 ), at( 0.215, 0, 0.365 ) ); // laser scanner
	Mesh column = lathe(
	    smoothedProfile( { { 0.115, 0.41 }, { 0.098, 0.44 }, { 0.085, 0.50 }, { 0.083, 0.58 }, { 0.095, 0.618 } }, 2 ), 30 );
	Mesh stripe = loft( { { 0.205, 0.2975, 0.2675, 0, 0, 3.2 }, { 0.21, 0.3025, 0.2725, 0, 0, 3.2 },
	                        { 0.225, 0.301, 0.271, 0, 0, 3.2 }, { 0.23, 0.2955, 0.2655, 0, 0, 3.2 } },
	    36, false );
	return { "base", { { "base_shell.stl", shell, "shell" }, { "base_dark.stl", dark.add( column ), "graphite" },
	                     { "base_stripe.stl", stripe, "accent" } } };
}

std::vector<Link> makeTorso()
{
	Mesh hip = lathe(
	    { { 0.07, 0.0 }, { 0.108, 0.004 }, { 0.118, 0.016 }, { 0.118, 0.042 }, { 0.108, 0.055 }, { 0.075, 0.058 } }, 36 );
	hip.add( drum( 0.036, -0.085, 0.085, 0.008, 24 ).placed( at( 0, 0, 0.085 ) * alongY ) ); // pitch axle
	Mesh waist = loft( domed( smoothed( { { -0.040, 0.072, 0.084, 0, 0, 2.4 }, { -0.015, 0.088, 0.104, 0, 0, 2.6 },
	                                        { 0.035, 0.090, 0.108, 0, 0, 2.6 }, { 0.065, 0.078, 0.094, 0, 0, 2.5 } },
	                              2 ),
	                       0.006, 0.012, 2 ),
	    28 );
	waist.add( sphere( 0.062, 20, 8 ), at( 0, 0, 0.088 ) ); // roll joint
	Mesh chest = loft( domed( smoothed( { { 0.03, 0.078, 0.092, 0, 0, 2.6 }, { 0.09, 0.092, 0.112, 0, 0, 2.8 },
	                                        { 0.20, 0.112, 0.142, 0.008, 0, 2.8 }, { 0.33, 0.128, 0.165, 0.016, 0, 2.9 },
	                                        { 0.43, 0.118, 0.162, 0.006, 0, 2.8 }, { 0.505, 0.088, 0.125, -0.006, 0, 2.4 },
	                                        { 0.54, 0.060, 0.070, -0.010, 0, 2.1 } },
	                              2 ),
	                       0.018, 0, 3 ),
	    34 );
	const Mesh plate =
	    loft( domed( { { -0.045, 0.060, 0.030, 0, 0, 3 }, { 0.035, 0.078, 0.030, 0, 0, 3 } }, 0.015, 0.020, 4 ), 26 );
	Mesh trim = plate.placed( at( 0.1235, 0, 0.345, 0, 0, 0.5 * pi ) ); // chest plate
	Mesh pack = roundedBox( { 0.085, 0.22, 0.27 }, 0.03, 3 ).placed( at( -0.118, 0, 0.30, 0, 0.06 ) );
	for ( int side = -1; side <= 1; side += 2 )
		pack.add(
		    drum( 0.066, 0.11, 0.172, 0.010, 22 ), at( 0, 0, 0.43 ) * ( side > 0 ? alongY : at( 0, 0, 0, 0.5 * pi ) ) );
	Mesh light = drum( 0.018, 0, 0.008, 0.003, 20 ).placed( at( 0.1500, 0, 0.345 ) * alongX );
	return { { "torso_yaw_link", { { "hip.stl", hip, "graphite" } } },
	    { "torso_pitch_link", { { "waist.stl", waist, "grey" } } },
	    { "chest", { { "chest_shell.stl", chest, "shell" }, { "chest_plate.stl", trim, "grey" },
	                   { "chest_pack.stl", pack, "graphite" }, { "chest_light.stl", light, "accent" } } } };
}

std::vector<Link> makeHead()
{
	Mesh neck = lathe( { { 0, -0.005 }, { 0.044, -0.005 }, { 0.048, 0.0 }, { 0.044, 0.006 }, { 0.039, 0.010 },
	                       { 0.044, 0.016 }, { 0.039, 0.022 }, { 0.044, 0.028 }, { 0.037, 0.034 }, { 0, 0.034 } },
	    24 );
	Mesh nod = drum( 0.026, -0.05, 0.05, 0.006, 20 ).placed( alongY );
	Mesh skull = loft( domed( smoothed( { { 0.018, 0.052, 0.046, 0.004, 0, 2.3 }, { 0.05, 0.082, 0.066, 0.012, 0, 2.4 },
	                                        { 0.10, 0.098, 0.078, 0.010, 0, 2.4 }, { 0.155, 0.098, 0.078, 0.002, 0, 2.4 } },
	                              2 ),
	                       0.006, 0.062, 5 ),
	    28 );
	// visor: a slice of a slightly larger head, pushed forward
	Mesh visor = loft( domed( { { 0.085, 0.082, 0.070, 0.032, 0, 2.8 }, { 0.10, 0.0885, 0.0745, 0.0315, 0, 2.8 },
	                              { 0.150, 0.0885, 0.0745, 0.0265, 0, 2.8 } },
	                       0.012, 0.018, 3 ),
	    28 );
	Mesh trim;
	for ( int side = -1; side <= 1; side += 2 )
		trim.add( drum( 0.034, 0.064, 0.092, 0.007, 20 ),
		    at( -0.008, 0, 0.115 ) * ( side > 0 ? alongY : at( 0, 0, 0, 0.5 * pi ) ) );
	Mesh eyes;
	for ( int side = -1; side <= 1; side += 2 )
		eyes.add( sphere( 0.0135, 12, 6 ), at( 0.1125, 0.030 * side, 0.126 ) );
	return { { "neck_yaw_link", { { "neck.stl", neck, "graphite" } } },
	    { "neck_pitch_link", { { "nod.stl", nod, "graphite" } } },
	    { "head", { { "head_shell.stl", skull, "shell" }, { "head_visor.stl", visor, "visor" },
	                  { "head_trim.stl", trim, "accent" }, { "head_eyes.stl", eyes, "eye" } } } };
}

/// A finger bone from z = 0 down to -length, tapered, with round ends.
Mesh phalanx( double length, double radius, double taper )
{
	return loft( domed( { { -length, taper * radius, taper * radius }, { -0.45 * length, 0.97 * radius, radius },
	                        { 0, radius, radius } },
	                 taper * radius, radius, 2 ),
	    8 );
}

/// Left arm; the right one is its mirror image. Shoulder cap, cuff, upper arm, elbow, forearm, wrist, palm.
std::vector<Link> makeArm()
{
	// shoulder_pitch: from the chest's side outwards, a cap over the roll axis at y = 0.085
	Mesh cap =
	    loft( domed( { { 0.0, 0.056, 0.056 }, { 0.012, 0.064, 0.064 }, { 0.030, 0.070, 0.070 }, { 0.085, 0.072, 0.072 } }, 0,
	              0.060, 4 ),
	        24 );
	Mesh shoulder = cap.placed( alongY );
	// shoulder_roll: axle along x inside the cap's fork, and the cuff below
	Mesh cuff = loft(
	    smoothed(
	        { { -0.035, 0.050, 0.050 }, { -0.062, 0.063, 0.063 }, { -0.085, 0.060, 0.060 }, { -0.100, 0.048, 0.048 } }, 2 ),
	    22 );
	cuff.add( drum( 0.032, -0.078, 0.078, 0.006, 16 ).placed( alongX ) );
	Mesh upper = loft( domed( smoothed( { { -0.168, 0.040, 0.043, 0.002, 0, 2.3 }, { -0.12, 0.047, 0.050, 0.003, 0, 2.2 },
	                                        { -0.06, 0.055, 0.056, 0.004, 0, 2.1 }, { -0.005, 0.047, 0.047, 0, 0, 2 } },
	                              2 ),
	                       0.012, 0, 2 ),
	    22 );
	Mesh upperBand = lathe( { { 0.0525, -0.042 }, { 0.0605, -0.038 }, { 0.0605, -0.026 }, { 0.0515, -0.022 } }, 24, false )
	                     .placed( at( 0.003, 0, 0 ) );
	Mesh elbow = drum( 0.042, -0.048, 0.048, 0.010, 22 ).placed( alongY );
	Mesh elbowCuff =
	    loft( smoothed( { { -0.030, 0.036, 0.040 }, { -0.060, 0.046, 0.047 }, { -0.090, 0.041, 0.041 } }, 2 ), 22 );
	Mesh forearm = loft( domed( smoothed( { { -0.140, 0.027, 0.030 }, { -0.105, 0.033, 0.037 },
	                                          { -0.045, 0.045, 0.047, 0.002 }, { -0.004, 0.039, 0.039 } },
	                                2 ),
	                         0.012, 0, 2 ),
	    22 );
	Mesh wrist = sphere( 0.0245, 14, 8 );
	// palm: broad along x, thin along y, knuckles at z = -0.105
	Mesh palm = loft( domed( smoothed( { { -0.100, 0.042, 0.014, 0, 0.001, 2.8 }, { -0.070, 0.043, 0.0165, 0, 0.001, 2.8 },
	                                       { -0.040, 0.036, 0.018, 0, 0, 2.5 }, { -0.022, 0.024, 0.017, 0, 0, 2.2 } },
	                             2 ),
	                      0.007, 0.006, 2 ),
	    20 );
	return { { "shoulder_pitch_link", { { "shoulder.stl", shoulder, "shell" } } },
	    { "shoulder_roll_link", { { "cuff.stl", cuff, "graphite" } } },
	    { "upperarm_link", { { "upperarm.stl", upper, "shell" }, { "upperarm_band.stl", upperBand, "accent" } } },
	    { "elbow_link", { { "elbow.stl", elbow.add( elbowCuff ), "graphite" } } },
	    { "forearm_link", { { "forearm.stl", forearm, "shell" } } },
	    { "wrist_link", { { "wrist.stl", wrist, "graphite" } } }, { "hand", { { "palm.stl", palm, "grey" } } } };
}

/// The right-hand twin of a vector or axis that belongs to the left side.
Vec3 mirrored( Vec3 v, bool right )
{
	return { v.x, right ? -v.y : v.y, v.z };
}

struct Finger
{
	const char* name;
	Vec3 root, rpy;
	double lengths[3], radius;
	double bend[3];
};

void addHand( Robot& robot, const std::string& side, bool right )
{
	// palms look inwards (-y on the left hand), thumbs forward; bending turns about x
	static const Finger fingers[5] = {
	    { "thumb", { 0.036, -0.004, -0.048 }, { 0, -0.85, 0 }, { 0.036, 0.028, 0.022 }, 0.0105, { 0.35, 0.25, 0.25 } },
	    { "index", { 0.031, 0.001, -0.104 }, { 0, -0.06, 0 }, { 0.038, 0.026, 0.020 }, 0.0088, { 0.12, 0.22, 0.18 } },
	    { "middle", { 0.0105, 0.001, -0.107 }, { 0, -0.02, 0 }, { 0.042, 0.029, 0.021 }, 0.0090, { 0.14, 0.24, 0.20 } },
	    { "ring", { -0.0105, 0.001, -0.106 }, { 0, 0.02, 0 }, { 0.039, 0.027, 0.020 }, 0.0087, { 0.17, 0.26, 0.20 } },
	    { "pinky", { -0.031, 0.001, -0.102 }, { 0, 0.07, 0 }, { 0.031, 0.021, 0.018 }, 0.0080, { 0.20, 0.28, 0.22 } } };
	static const char* bones[3] = { "proximal", "middle", "distal" };
	for ( const Finger& finger : fingers )
	{
		std::string parent = side + "_hand";
		for ( int b = 0; b < 3; ++b )
		{
			const std::string name = side + "_" + finger.name + "_" + bones[b];
			const Mesh bone = phalanx( finger.lengths[b] - 0.003, finger.radius * ( 1 - 0.07 * b ), b == 2 ? 0.80 : 0.92 );
			robot.links.push_back(
			    { name, { { name + ".stl", right ? bone.mirroredY() : bone, b == 2 ? "grey" : "graphite" } } } );
			const Vec3 root = b == 0 ? finger.root : Vec3{ 0, 0, -finger.lengths[b - 1] };
			// bending towards the palm: -x axis on the left, +x on the right; the spread about y is the same on both
			const double bend = ( right ? 1 : -1 ) * finger.bend[b];
			const Vec3 rpy = { bend, b == 0 ? finger.rpy.y : 0, 0 };
			robot.joints.push_back( { name + "_joint", "fixed", parent, name, mirrored( root, right ), rpy, {}, 0, 0 } );
			parent = name;
		}
	}
	robot.links.push_back( { side + "_tcp", {} } );
	robot.joints.push_back( { side + "_tcp_joint", "fixed", side + "_hand", side + "_tcp",
	    mirrored( { 0, -0.03, -0.115 }, right ), {}, {}, 0, 0 } );
}

void addArm( Robot& robot, const std::string& side, bool right )
{
	for ( Link link : makeArm() )
	{
		for ( Part& part : link.parts )
		{
			part.file = side + "_" + part.file;
			if ( right )
				part.mesh = part.mesh.mirroredY();
		}
		link.name = side + "_" + link.name;
		robot.links.push_back( link );
	}
	// pitch axes point to the right: a positive angle lifts the limb forward. Roll and yaw axes are mirrored, so that equal
	// values on both sides are mirror images.
	const double m = right ? -1 : 1;
	const std::vector<Joint> joints = {
	    { "shoulder_pitch", "revolute", "chest", "shoulder_pitch_link", { 0, 0.180, 0.43 }, {}, { 0, -1, 0 }, -1.2, 2.9 },
	    { "shoulder_roll", "revolute", "shoulder_pitch_link", "shoulder_roll_link", { 0, 0.085, 0 }, {}, { m, 0, 0 }, -0.25,
	        2.2 },
	    { "upperarm_yaw", "revolute", "shoulder_roll_link", "upperarm_link", { 0, 0, -0.102 }, {}, { 0, 0, m }, -1.7, 1.7 },
	    { "elbow", "revolute", "upperarm_link", "elbow_link", { 0, 0, -0.205 }, {}, { 0, -1, 0 }, 0, 2.3 },
	    { "forearm_yaw", "revolute", "elbow_link", "forearm_link", { 0, 0, -0.092 }, {}, { 0, 0, m }, -2.0, 2.0 },
	    { "wrist_pitch", "revolute", "forearm_link", "wrist_link", { 0, 0, -0.172 }, {}, { 0, -1, 0 }, -1.0, 1.0 },
	    { "wrist_roll", "revolute", "wrist_link", "hand", { 0, 0, 0 }, {}, { m, 0, 0 }, -0.7, 0.7 } };
	for ( Joint joint : joints )
	{
		joint.name = side + "_" + joint.name;
		if ( joint.parent != "chest" )
			joint.parent = side + "_" + joint.parent;
		joint.child = side + "_" + joint.child;
		joint.xyz = mirrored( joint.xyz, right );
		robot.joints.push_back( joint );
	}
	addHand( robot, side, right );
}

void addGroups( Robot& robot )
{
	std::vector<std::string> base, torso, head, arms[2], fingers;
	for ( const Joint& joint : robot.joints )
		if ( joint.type != "fixed" )
		{
			if ( joint.name.rfind( "base_", 0 ) == 0 )
				base.push_back( joint.name );
			else if ( joint.name.rfind( "torso_", 0 ) == 0 )
				torso.push_back( joint.name );
			else if ( joint.name.rfind( "left_", 0 ) == 0 || joint.name.rfind( "right_", 0 ) == 0 )
				arms[joint.name[0] == 'r'].push_back( joint.name );
			else
				head.push_back( joint.name );
		}
	auto joined = []( std::vector<std::vector<std::string>> lists )
	{
		std::vector<std::string> all;
		for ( auto& list : lists )
			all.insert( all.end(), list.begin(), list.end() );
		return all;
	};
	robot.groups = { { "base", base }, { "torso", torso }, { "head", head }, { "left_arm", arms[0] },
	    { "right_arm", arms[1] }, { "both_arms", joined( { arms[0], arms[1] } ) },
	    { "torso_left_arm", joined( { torso, arms[0] } ) }, { "torso_right_arm", joined( { torso, arms[1] } ) },
	    { "torso_both_arms", joined( { torso, arms[0], arms[1] } ) },
	    { "whole_body", joined( { base, torso, head, arms[0], arms[1] } ) } };
}

} // namespace

Robot makeRobot()
{
	Robot robot;
	robot.links = { { "world", {} }, { "base_x_link", {} }, { "base_y_link", {} }, makeBase() };
	for ( const Link& link : makeTorso() )
		robot.links.push_back( link );
	for ( const Link& link : makeHead() )
		robot.links.push_back( link );
	robot.joints = { { "base_x", "prismatic", "world", "base_x_link", {}, {}, { 1, 0, 0 }, 0, 4.4 },
	    { "base_y", "prismatic", "base_x_link", "base_y_link", {}, {}, { 0, 1, 0 }, 0, 3.6 },
	    { "base_yaw", "continuous", "base_y_link", "base", {}, {}, { 0, 0, 1 }, 0, 0 },
	    { "torso_yaw", "revolute", "base", "torso_yaw_link", { -0.01, 0, 0.625 }, {}, { 0, 0, 1 }, -1.0, 1.0 },
	    { "torso_pitch", "revolute", "torso_yaw_link", "torso_pitch_link", { 0, 0, 0.085 }, {}, { 0, 1, 0 }, -0.3, 1.0 },
	    { "torso_roll", "revolute", "torso_pitch_link", "chest", { 0, 0, 0.085 }, {}, { 1, 0, 0 }, -0.35, 0.35 },
	    { "head_yaw", "revolute", "chest", "neck_yaw_link", { -0.010, 0, 0.548 }, {}, { 0, 0, 1 }, -1.2, 1.2 },
	    { "head_pitch", "revolute", "neck_yaw_link", "neck_pitch_link", { 0, 0, 0.055 }, {}, { 0, 1, 0 }, -0.4, 0.5 },
	    { "head_roll", "revolute", "neck_pitch_link", "head", { 0, 0, 0.012 }, {}, { 1, 0, 0 }, -0.3, 0.3 } };
	addArm( robot, "left", false );
	addArm( robot, "right", true );
	addGroups( robot );
	for ( const Joint& joint : robot.joints )
		if ( joint.type != "fixed" && joint.parent != "world" && joint.parent != "base_x_link" &&
		     joint.parent != "base_y_link" )
			robot.allowed.push_back( { joint.parent, joint.child, "Adjacent" } );
	return robot;
}

size_t Robot::movableJoints() const
{
	size_t count = 0;
	for ( const Joint& joint : joints )
		count += joint.type != "fixed";
	return count;
}

size_t Robot::triangles() const
{
	size_t count = 0;
	for ( const Link& link : links )
		for ( const Part& part : link.parts )
			count += part.mesh.triangles.size();
	return count;
}

const Group& Robot::group( const std::string& name ) const
{
	for ( const Group& candidate : groups )
		if ( candidate.name == name )
			return candidate;
	throw std::out_of_range( "no group " + name );
}

} // namespace kitchen
