// SPDX-License-Identifier: BSD-3-Clause
// leeway audit: an independent look at a path file; and certificates of all subcommands.
#include "leeway/handles.hpp"
#include "leeway/motions/motion_files.hpp"
#include "leeway/motions/path_file.hpp"
#include "motions/report.hpp"
#include "commands/certificate_file.hpp"
#include "commands/page_file.hpp"

#include <fmt/format.h>

#include <optional>

namespace leeway::cli
{

// ---- certificates ------------------------------------------------------------------------------------------------------

std::vector<std::string> filesOf( const CommonOptions& options, const std::string& motion )
{
	std::vector<std::string> files;
	for ( const std::string& file : { options.robot, options.srdf, options.scene, motion } )
	{
		if ( !file.empty() )
		{
			files.push_back( file );
		}
	}
	return files;
}

certify::Settings claimOf( double min_d, lw_check_flags flags, std::vector<std::string> files )
{
	certify::Settings settings;
	settings.min_d = min_d;
	settings.flags = flags;
	settings.sources = std::move( files );
	return settings;
}

CertificateFile::CertificateFile( const std::string& path )
{
	if ( !path.empty() )
	{
		m_file.emplace( "--certificate", path );
	}
}

bool CertificateFile::write( const io::Problem& problem, const Input& input, const std::vector<certify::Piece>& pieces,
    const certify::Settings& settings, const std::string& name, std::vector<OutputFile*>& files )
{
	if ( !m_file )
	{
		return true;
	}
	try
	{
		certify::Certificate certificate = certify::certify( problem, input.robot, pieces, settings, name );
		m_told = fmt::format(
		    "{}, made in {:.2f} ms\n", certify::describe( certificate, m_file->path() ), 1e3 * certificate.seconds );
		m_file->text = std::move( certificate.bytes );
	}
	catch ( const io::Error& error )
	{
		tell( "leeway: no certificate: {}\n", error.what() );
		return false;
	}
	files.push_back( &*m_file );
	return true;
}

// ---- leeway audit ------------------------------------------------------------------------------------------------------

namespace
{

RoundingAudit proveCorners(
    const Workbench& bench, const std::vector<std::vector<double>>& points, const AuditOptions& options, double min_d )
{
	lw_edge_def def = lw_edge_def_default();
	const std::vector<double> tolerance =
	    tolerances( bench.problem(), "command line", {}, givenTolerances( options.tolerance ) );
	def.tolerance = tolerance.empty() ? nullptr : tolerance.data();
	def.min_d = min_d;
	def.flags = options.common.checkFlags();
	return auditRoundings( bench.problem(), points, options.corner_blend, def, options.path );
}

/// @return false: a certificate is wanted, and there is none
bool writeCertificate( const AuditOptions& options, const Input& input, const io::Problem& problem,
    const std::vector<std::vector<double>>& points, const AuditSettings& settings, CertificateFile& certificate,
    std::vector<OutputFile*>& files )
{
	certify::Settings claim = claimOf( settings.min_d, settings.flags, filesOf( options.common, options.path ) );
	claim.tolerance = tolerances( problem, "command line", {}, givenTolerances( options.tolerance ) );
	claim.seconds = settings.time;
	return certificate.write( problem, input, certify::piecesOf( problem, points ), claim, options.path, files );
}

} // namespace

int runAudit( const AuditOptions& options )
{
	Notices notices( options.common.verbose );
	const PathFile path = readPath( options.path );
	readsFile( "--path", options.path );
	OutputFile report( "--report", options.report ), profile_file( "--profile", options.profile );
	CertificateFile certificate( options.certificate );
	ViewFile view( options.view );
	const Input input = loadInput( options.common, notices );
	if ( !path.robot.empty() && path.robot != input.robot.name )
	{
		notices.add( "the path",
		    fmt::format( "{}: it was planned for robot '{}', this is '{}'", path.file, path.robot, input.robot.name ) );
	}
	const std::string group = groupOf( path, options.common.group, input.robot );
	std::vector<io::Notice> unused;
	const Values start = startValues( path, input.robot, unused );
	notices.add( "unused joints", unused );
	const Workbench bench( input, group, start, notices );
	const std::vector<std::vector<double>> points = groupPoints( path, bench.problem() );
	notices.add( "keys of the path", path.notices );
	for ( const std::string& violation : limitViolations( bench.robot(), bench.problem().reference ) )
	{
		notices.add( "joint limits", fmt::format( "{}: start_state: {}", path.file, violation ) );
	}

	AuditSettings settings;
	settings.min_d = options.common.min_d_given ? options.common.min_d : path.min_d;
	settings.resolution = options.resolution;
	settings.time = options.time;
	settings.flags = options.common.checkFlags();
	Audit audit = audited( bench, points, settings, path.file );
	if ( input.request )
	{
		auditEnds( bench.problem(), *input.request, points, audit );
	}
	std::optional<RoundingAudit> corners;
	if ( options.corner_blend > 0 )
	{
		corners = proveCorners( bench, points, options, settings.min_d );
	}
	std::vector<OutputFile*> files;
	if ( !options.report.empty() )
	{
		Json json;
		json["path"] = options.path;
		json["robot"] = input.robot.name;
		json["group"] = group;
		json["points"] = points.size();
		json["audit"] = toJson( audit, settings );
		if ( corners )
		{
			json["roundings"] = toJson( *corners );
		}
		json["notices"] = notices.all();
		report.text = jsonText( json );
		files.push_back( &report );
	}
	if ( !options.profile.empty() )
	{
		profile_file.text = profileCsv( audit );
		files.push_back( &profile_file );
	}
	const bool is_certified =
	    !audit.valid || writeCertificate( options, input, bench.problem(), points, settings, certificate, files );
	if ( view.isWanted() )
	{
		Progress progress( "measuring the motion" );
		ViewMotion motion =
		    motionOfPath( { bench.problem(), settings.flags, settings.min_d, path.file, shownBy( progress ) }, points );
		PageInput page = pageOf( input, bench.problem(), std::move( motion ), settings.flags );
		page.min_d = settings.min_d;
		page.source = options.path;
		page.notes = audit.problems;
		view.write( page, files );
	}
	commitTogether( files );
	printOut( describe( audit, settings, points.size() ) + ( corners ? describe( *corners ) : "" ) + certificate.told() );
	return audit.valid && is_certified && ( !corners || corners->valid() ) ? exit_yes : exit_no;
}

} // namespace leeway::cli
