// SPDX-License-Identifier: BSD-3-Clause
// leeway::motions from an installed package: a trajectory and a path are read, and a file that is not there is an error that names it.
#include <leeway/motions/audit.hpp>
#include <leeway/motions/motion_files.hpp>
#include <leeway/motions/roundings.hpp>
#include <leeway/motions/stage.hpp>
#include <leeway/motions/timed.hpp>

#include <cstdio>
#include <fstream>
#include <string>

int main()
{
	using namespace leeway;
	std::ofstream( "consumer_trajectory.csv" ) << "time,slide\n0,0\n2,1\n";
	const std::vector<motions::TrajectoryFile> read = motions::readTrajectories( "consumer_trajectory.csv" );
	std::remove( "consumer_trajectory.csv" );
	bool ok = read.size() == 1 && read[0].points.size() == 2 && read[0].points[1].time == 2;

	motions::RoundingProof proof;
	ok = ok && motions::proveRoundings( nullptr, nullptr, {}, 1, lw_edge_def_default(), proof ) == LW_ERROR_INVALID_ARGUMENT;
	try
	{
		motions::readPath( "no_such_path.yaml" );
	}
	catch ( const io::Error& error )
	{
		return ok && std::string( error.what() ).find( "no_such_path.yaml" ) != std::string::npos ? 0 : 1;
	}
	return 2;
}
