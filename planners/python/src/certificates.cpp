// SPDX-License-Identifier: BSD-3-Clause
// Certificates of paths and trajectories, and bubbles of states: the library leeway::certify.
#include "objects.hpp"

#include "leeway/certify/bubble.hpp"
#include "leeway/certify/certificate.hpp"
#include "leeway/motions/motion_files.hpp"
#include "leeway/motions/path_file.hpp"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <mutex>

namespace leeway::python
{

struct Certifier
{
	Certifier( std::shared_ptr<const io::Problem> of_problem, std::shared_ptr<const io::RobotModel> of_model )
	    : problem( std::move( of_problem ) ), model( std::move( of_model ) )
	{
	}
	certify::Writer& writer()
	{
		m_writer = m_writer ? std::move( m_writer ) : std::make_unique<certify::Writer>( *problem, *model );
		return *m_writer;
	}
	certify::Bubbles& bubbles( lw_check_flags flags )
	{
		std::unique_ptr<certify::Bubbles>& of = m_bubbles[static_cast<std::size_t>( flags ) % 4];
		of = of ? std::move( of ) : std::make_unique<certify::Bubbles>( *problem, *model, flags );
		return *of;
	}

	const std::shared_ptr<const io::Problem> problem;
	const std::shared_ptr<const io::RobotModel> model;
	std::mutex mutex; ///< of all that follows

private:
	std::unique_ptr<certify::Writer> m_writer;
	std::unique_ptr<certify::Bubbles> m_bubbles[4]; ///< by flags
};

std::shared_ptr<Certifier> newCertifier(
    std::shared_ptr<const io::Problem> problem, std::shared_ptr<const io::RobotModel> model )
{
	return std::make_shared<Certifier>( std::move( problem ), std::move( model ) );
}

namespace
{

using namespace nb::literals;

certify::Settings claimOf( double min_d, const std::string& check, const std::vector<std::string>& sources, double seconds )
{
	certify::Settings settings;
	settings.min_d = min_d;
	settings.flags = checkFlags( check );
	settings.sources = sources;
	settings.seconds = seconds;
	if ( !( min_d >= 0 ) )
	{
		throw nb::value_error( "min_d: is no number of 0 or more" );
	}
	return settings;
}

nb::bytes written( const PyChecker& checker, const std::vector<certify::Piece>& pieces, const certify::Settings& settings,
    const std::string& file )
{
	certify::Certificate certificate;
	{
		const nb::gil_scoped_release unlocked;
		const std::lock_guard<std::mutex> lock( checker.certifier->mutex );
		certificate = checker.certifier->writer().write( pieces, settings, file );
	}
	return nb::bytes( certificate.bytes.data(), certificate.bytes.size() );
}

nb::bytes ofPath( const PyChecker& checker, const nb::object& given, const std::optional<double>& min_d,
    const std::string& check, const nb::object& tolerance, const std::vector<std::string>& sources, double seconds )
{
	std::vector<std::vector<double>> points;
	std::string file = fileName( given );
	double of_file = 0;
	if ( !file.empty() )
	{
		const motions::PathFile path = motions::readPath( file );
		const std::vector<std::string> elsewhere = motions::startDifferences( path, *checker.problem );
		if ( !elsewhere.empty() )
		{
			throw io::Error( path.file, "start_state", elsewhere.front(),
			    "give the checker this state of the joints: Checker(..., reference=)" );
		}
		points = motions::groupPoints( path, *checker.problem );
		of_file = path.min_d;
	}
	else
	{
		file = "path";
		const Doubles numbers = nb::cast<Doubles>( given );
		const Rows rows = rowsOf( numbers, checker.variables(), "path", "variables of the group" );
		for ( std::size_t i = 0; i < rows.count; ++i )
		{
			points.emplace_back( rows[i], rows[i] + rows.width );
		}
		if ( points.empty() )
		{
			throw nb::value_error( "path: has no rows" );
		}
	}
	certify::Settings settings = claimOf( min_d.value_or( of_file ), check, sources, seconds );
	settings.tolerance = toleranceOf( checker, file, {}, tolerance );
	return written( checker, certify::piecesOf( *checker.problem, points ), settings, file );
}

nb::bytes ofTrajectory( const PyChecker& checker, const nb::object& times, const nb::object& positions,
    const nb::object& velocities, const nb::object& accelerations, const std::string& interpolation, double min_d,
    const std::string& check, const nb::object& tolerance, const std::vector<std::string>& sources, double seconds )
{
	const std::vector<motions::TrajectoryFile> files =
	    trajectoriesOf( checker, times, positions, velocities, accelerations );
	const motions::TrajectoryFile& file = files.front();
	if ( files.size() != 1 )
	{
		throw io::Error( file.file, "trajectories",
		    "a certificate has one, and the file has " + std::to_string( files.size() ), "give them one by one" );
	}
	const std::vector<motions::Segment> segments =
	    motions::segmentsOf( *checker.problem, file, interpolationOf( interpolation ), 0 );
	std::vector<certify::Piece> pieces;
	for ( const motions::Segment& segment : segments )
	{
		pieces.push_back( { segment.degree, segment.points, segment.seconds } );
	}
	certify::Settings settings = claimOf( min_d, check, sources, seconds );
	settings.tolerance = toleranceOf( checker, file.file, file.path_tolerance, tolerance );
	settings.begin = segments.empty() ? 0 : segments.front().begin;
	return written( checker, pieces, settings, file.file );
}

nb::object bubble( const PyChecker& checker, const Doubles& state, double min_d, const std::string& check, double most )
{
	const Rows rows = rowsOf( state, checker.variables(), "state", "variables of the group" );
	const lw_check_flags flags = checkFlags( check );
	if ( !( min_d >= 0 ) || !( most > 0 ) )
	{
		throw nb::value_error( "min_d, most: are numbers of 0 or more, and above 0" );
	}
	if ( rows.count != 1 )
	{
		throw nb::value_error( "state: give one" );
	}
	const NewArray<double> out( { rows.width } );
	lw_status status;
	{
		const nb::gil_scoped_release unlocked;
		const std::lock_guard<std::mutex> lock( checker.certifier->mutex );
		const Lease query( *checker.queries );
		status = checker.certifier->bubbles( flags ).at( query.get(), rows[0], min_d, most, out.data );
	}
	if ( status != LW_OK )
	{
		failState( status, rows, 0 );
	}
	return out.object;
}

} // namespace

void bindCertificates( nb::class_<PyChecker>& type )
{
	type.def( "certificate", &ofPath, "path"_a, nb::kw_only(), "min_d"_a = nb::none(), "check"_a = "both",
	    "tolerance"_a = nb::none(), "sources"_a = std::vector<std::string>(), "seconds"_a = 60.0,
	    nb::sig(
	        "def certificate(self, path: str | os.PathLike | numpy.typing.ArrayLike, *, min_d: float | None = None, check: str = 'both', "
	        "tolerance: numpy.typing.ArrayLike | None = None, sources: list[str] = [], seconds: float = 60.0) -> bytes" ),
	    "A certificate of a path, which leeway.certificate.check() and the programs beside it check: `leeway audit --certificate`.\n\n"
	    "path: float64 [n, dof], or a path file. min_d: of the file unless given, else 0. tolerance: float64 [dof], deviations for which it holds.\n"
	    "sources: files whose SHA-256 is stored. seconds: then it is an error. Raises InputError if the path is not free, and names the pair.\n"
	    "The first one of a checker takes some milliseconds more than others." );
	type.def( "certificate_trajectory", &ofTrajectory, "times"_a, "positions"_a = nb::none(), "velocities"_a = nb::none(),
	    "accelerations"_a = nb::none(), nb::kw_only(), "interpolation"_a = "auto", "min_d"_a = 0.0, "check"_a = "both",
	    "tolerance"_a = nb::none(), "sources"_a = std::vector<std::string>(), "seconds"_a = 60.0,
	    nb::sig(
	        "def certificate_trajectory(self, times: numpy.typing.ArrayLike | str | os.PathLike, positions: numpy.typing.ArrayLike | None = None, "
	        "velocities: numpy.typing.ArrayLike | None = None, accelerations: numpy.typing.ArrayLike | None = None, *, "
	        "interpolation: str = 'auto', min_d: float = 0.0, check: str = 'both', tolerance: numpy.typing.ArrayLike | None = None, "
	        "sources: list[str] = [], seconds: float = 60.0) -> bytes" ),
	    "The same of a timed trajectory: `leeway audit --trajectory --certificate`.\n\n"
	    "times, positions, velocities, accelerations, interpolation: as of audit_trajectory(); a file has one trajectory. tolerance: float64 [dof],\n"
	    "else that of the file's goal. Limits are not looked at, nor the way to a first point after 0 s: audit_trajectory() does." );
	type.def( "bubble", &bubble, "state"_a, nb::kw_only(), "min_d"_a = 0.0, "check"_a = "both", "most"_a = 0.5,
	    nb::sig(
	        "def bubble(self, state: numpy.typing.ArrayLike, *, min_d: float = 0.0, check: str = 'both', most: float = 0.5) -> "
	        "numpy.typing.NDArray[numpy.float64]" ),
	    "How far each joint may go from a state, all of them together: a proved box around it.\n\n"
	    "state: float64 [dof]. Returns float64 [dof], radians and metres: every state within is at more than min_d of all.\n"
	    "Joints grow alike, weighted by what they move, until a link's room is used, and the others grow on, none above `most`. 0: the\n"
	    "state is not proved free. Joint limits are not looked at. Some 20 us for an arm. Cost, proof: planners/certify/FORMAT.md, Path." );
}

} // namespace leeway::python
