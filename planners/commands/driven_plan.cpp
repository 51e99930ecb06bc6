// SPDX-License-Identifier: BSD-3-Clause
// The proof, the certificate and the page are of the motion that a reader of the trajectory's file drives.
#include "commands/driven_plan.hpp"
#include "commands/limits_file.hpp"
#include "commands/plan_solution.hpp"
#include "motions/report.hpp"

#include <filesystem>

namespace leeway::cli
{

motions::MotionSettings settingsOf(
    const PlanOptions& options, const Input& input, const io::Problem& problem, const JointLimits& limits, Notices& notices )
{
	motions::MotionSettings settings;
	settings.edge.min_d = options.common.min_d;
	settings.edge.flags = options.common.checkFlags();
	settings.edge.slack = options.edge.slack;
	settings.limits = motionLimits( problem, input.robot, limits );
	noteUsual( settings.limits, notices );
	settings.seed = options.seed;
	return settings;
}

manifold::Settings requestSettingsOf(
    const PlanOptions& options, const Input& input, const io::Problem& problem, const JointLimits& limits, Notices& notices )
{
	manifold::Settings settings{ settingsOf( options, input, problem, limits, notices ) };
	settings.seconds = timeLimit( options, *input.request );
	settings.shortcuts = options.simplify ? settings.shortcuts : 0;
	return settings;
}

namespace
{

/// "leg 2", "legs 3 to 5"
std::string legsOf( const sequence::Chapter& chapter )
{
	return chapter.legs == 1 ? fmt::format( "leg {}", chapter.leg + 1 )
	                         : fmt::format( "legs {} to {}", chapter.leg + 1, chapter.leg + chapter.legs );
}

} // namespace

DrivenPlan::DrivenPlan( const PlanOptions& options )
    : m_options( options ), m_timed( "--trajectory", options.trajectory ), m_report( "--report", options.report ),
      m_view( options.view )
{
	m_certificates.emplace_back( options.certificate );
}

const std::vector<Segment>& DrivenPlan::drive( const io::Problem& problem, const Input& input,
    const std::vector<Segment>& segments, const JointLimits& limits, const std::string& name, const Chapters& chapters )
{
	const TrajectoryFile file = endsOf( problem, segments, io::startState( problem ) );
	TrajectorySettings settings;
	settings.edge.min_d = m_options.common.min_d;
	settings.edge.flags = m_options.common.checkFlags();
	settings.edge.slack = m_options.edge.slack;
	settings.limits = limits;
	m_name = name;
	m_segments = segmentsOf( problem, file, Interpolation::automatic, 0 );
	const std::shared_ptr<const io::Problem> only( std::shared_ptr<const io::Problem>(), &problem ); // the caller's
	m_chapters = chapters ? chapters( m_segments ) : std::vector<sequence::Chapter>{ { only, 0, 1, m_segments } };
	const TrajectoryAudit audit = sequence::auditChapters( input.robot, m_chapters, name, settings );
	m_timed.text = robotTrajectory( file );
	m_told = motions::describe( audit );
	m_proved = audit.valid();
	return m_segments;
}

PageInput DrivenPlan::page( const io::Problem& problem, const std::vector<Segment>& segments, const Input& input,
    std::vector<std::string> notes ) const
{
	const lw_check_flags flags = m_options.common.checkFlags();
	Progress progress( "measuring the motion" );
	const Measuring how = { problem, flags, m_options.common.min_d, m_options.common.request, shownBy( progress ) };
	ViewMotion motion = segments.empty()
	                        ? motionOfStates( problem, { io::startState( problem ) }, {}, flags, m_options.common.request )
	                        : motionOfTrajectory( how, segments );
	PageInput page = pageOf( input, problem, std::move( motion ), flags );
	page.min_d = m_options.common.min_d;
	page.source = m_options.trajectory;
	page.notes = std::move( notes );
	return page;
}

std::vector<PageInput> DrivenPlan::pages(
    const io::Problem& problem, const Input& input, const std::vector<std::string>& notes ) const
{
	std::vector<PageInput> pages;
	if ( m_chapters.empty() )
	{
		pages.push_back( page( problem, {}, input, notes ) );
	}
	for ( const sequence::Chapter& chapter : m_chapters )
	{
		pages.push_back( page( *chapter.problem, chapter.segments, input, notes ) );
		pages.back().chapter = m_chapters.size() == 1 ? "" : legsOf( chapter );
	}
	return pages;
}

bool DrivenPlan::certifyChapters( const Input& input, std::vector<OutputFile*>& files )
{
	const bool several = m_chapters.size() > 1 && !m_options.certificate.empty();
	const std::filesystem::path path = m_options.certificate;
	bool all = true;
	for ( std::size_t i = 0; i < m_chapters.size(); ++i )
	{
		const sequence::Chapter& chapter = m_chapters[i];
		if ( several )
		{
			std::filesystem::path numbered = path;
			numbered.replace_extension( std::to_string( i + 1 ) + path.extension().string() );
			m_certificates.emplace_back( numbered.string() );
		}
		std::vector<certify::Piece> pieces;
		for ( const Segment& segment : chapter.segments )
		{
			pieces.push_back( { segment.degree, segment.points, segment.seconds } );
		}
		const std::vector<std::string> sources = cli::filesOf( m_options.common, several ? m_options.common.request : "" );
		CertificateFile& certificate = m_certificates.back();
		all = certificate.write( *chapter.problem, input, pieces,
		          claimOf( m_options.common.min_d, m_options.common.checkFlags(), sources ),
		          several ? fmt::format( "{}, {}", m_name, legsOf( chapter ) ) : m_name, files ) &&
		      all;
		m_certified += certificate.told();
	}
	return all;
}

int DrivenPlan::finish( const io::Problem& problem, const Input& input, bool good, const std::string& text,
    std::string report, const std::string& unproved, const std::vector<std::string>& notes )
{
	std::vector<OutputFile*> files;
	bool is_certified = true;
	if ( good )
	{
		files.push_back( &m_timed );
		is_certified = certifyChapters( input, files );
	}
	if ( !m_options.report.empty() )
	{
		m_report.text = std::move( report );
		files.push_back( &m_report );
	}
	if ( m_view.isWanted() )
	{
		m_view.write( pages( problem, input, notes ), files );
	}
	commitTogether( files );
	const std::string all =
	    text + m_certified + ( m_certified.empty() || unproved.empty() ? "" : "            " + unproved + "\n" );
	good && !m_options.trajectory.empty() ? printOut( all ) : tell( "{}", all );
	return good && is_certified ? exit_yes : exit_no;
}

} // namespace leeway::cli
