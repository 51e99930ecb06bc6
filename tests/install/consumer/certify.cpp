// SPDX-License-Identifier: BSD-3-Clause
// leeway::certify from an installed package: the certificate of a motion of three balls in a row, of which the first and the last are a pair.
#include <leeway/certify/certificate.hpp>

#include <fstream>

int main()
{
	std::ofstream( "consumer_certify.urdf" )
	    << "<robot name='r'><link name='a'><collision><geometry><sphere radius='0.5'/></geometry></collision></link>"
	       "<link name='b'><collision><geometry><sphere radius='0.5'/></geometry></collision></link>"
	       "<link name='c'><collision><geometry><sphere radius='0.5'/></geometry></collision></link>"
	       "<joint name='j' type='revolute'><parent link='a'/><child link='b'/><origin xyz='2 0 0'/><axis xyz='0 0 1'/>"
	       "<limit lower='-3' upper='3' effort='1' velocity='1'/></joint>"
	       "<joint name='k' type='fixed'><parent link='b'/><child link='c'/><origin xyz='2 0 0'/></joint></robot>";
	const leeway::io::RobotModel robot = leeway::io::loadRobot( "consumer_certify.urdf", "" );
	const leeway::io::Problem problem = leeway::io::buildProblem( robot, {} );
	const std::vector<leeway::certify::Piece> pieces = leeway::certify::piecesOf( problem, { { -1 }, { 1 } } );
	const leeway::certify::Certificate made = leeway::certify::certify( problem, robot, pieces, {}, "a motion" );
	return made.pairs == 1 && made.bytes.compare( 0, 8, "LWCERT2\n" ) == 0 ? 0 : 1;
}
