// SPDX-License-Identifier: BSD-3-Clause
// leeway::certify from an installed package: two bodies that never meet, and the certificate of a motion between them.
#include <leeway/certify/certificate.hpp>

#include <fstream>

int main()
{
	std::ofstream( "consumer_certify.urdf" )
	    << "<robot name='r'><link name='a'><collision><geometry><box size='1 1 1'/></geometry></collision></link>"
	       "<link name='b'><collision><origin xyz='3 0 0'/><geometry><box size='1 1 1'/></geometry></collision></link>"
	       "<link name='m'/><joint name='f' type='fixed'><parent link='a'/><child link='m'/></joint>"
	       "<joint name='j' type='revolute'><parent link='m'/><child link='b'/><axis xyz='0 0 1'/>"
	       "<limit lower='-3' upper='3' effort='1' velocity='1'/></joint></robot>";
	const leeway::io::RobotModel robot = leeway::io::loadRobot( "consumer_certify.urdf", "" );
	const leeway::io::Problem problem = leeway::io::buildProblem( robot, {} );
	const std::vector<leeway::certify::Piece> pieces = leeway::certify::piecesOf( problem, { { -1 }, { 1 } } );
	const leeway::certify::Certificate made = leeway::certify::certify( problem, robot, pieces, {}, "a motion" );
	return made.pairs == 1 && made.bytes.compare( 0, 8, "LWCERT1\n" ) == 0 ? 0 : 1;
}
