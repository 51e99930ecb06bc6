// SPDX-License-Identifier: BSD-3-Clause
// A planned motion of cubics as a controller drives it: its trajectory, the proof of that file's motion, its certificate and its page.
#pragma once

#include "commands/certificate_file.hpp"
#include "commands/page_file.hpp"

#include "leeway/manifold/plan.hpp"
#include "leeway/motions/timed.hpp"
#include "leeway/sequence/sequence.hpp"

#include <functional>
#include <list>

namespace leeway::cli
{

/// min_d, flags, slack and seed of the options, and the limits of the joints. A notice names each joint that keeps a usual limit.
motions::MotionSettings settingsOf( const PlanOptions& options, const Input& input, const io::Problem& problem,
    const JointLimits& limits, Notices& notices );
/// With the time and the shortcuts of a plan for the input's request, which has to be there.
manifold::Settings requestSettingsOf( const PlanOptions& options, const Input& input, const io::Problem& problem,
    const JointLimits& limits, Notices& notices );

/// The scenes of a motion as it is driven.
using Chapters = std::function<std::vector<sequence::Chapter>( const std::vector<Segment>& driven )>;

/// Results of plan --line and of plans with constraints. Files are opened at once.
class DrivenPlan
{
public:
	/// @throws io::Error for a file that cannot be written
	explicit DrivenPlan( const PlanOptions& options );
	/// Makes the trajectory, and proves clearances and limits of the segments that its reader drives.
	/// @param limits of the joints, in place of those of the robot
	/// @param segments none: the motion is the start state of the problem
	/// @param name of the motion, for errors @param chapters empty: all is driven in the scene of the problem
	/// @return these segments
	const std::vector<Segment>& drive( const io::Problem& problem, const Input& input, const std::vector<Segment>& segments,
	    const JointLimits& limits, const std::string& name, const Chapters& chapters = {} );
	/// Of the last drive: one, or those of the scenes.
	const std::vector<sequence::Chapter>& chapters() const { return m_chapters; }
	/// The last drive was proved.
	bool isProved() const { return m_proved; }
	/// Writes all files together, and tells.
	/// @param good the motion is written; else only the report and the page
	/// @param unproved a sentence for users: the claims that the certificate leaves out; empty: none
	/// @param notes sentences for the page
	/// @return exit status
	int finish( const io::Problem& problem, const Input& input, bool good, const std::string& text, std::string report,
	    const std::string& unproved, const std::vector<std::string>& notes );
	/// Lines for people about the last drive.
	const std::string& told() const { return m_told; }

private:
	PageInput page( const io::Problem& problem, const std::vector<Segment>& segments, const Input& input,
	    std::vector<std::string> notes ) const;
	std::vector<PageInput> pages(
	    const io::Problem& problem, const Input& input, const std::vector<std::string>& notes ) const;

	/// A certificate of each chapter. @return false: they are wanted, and one is not there
	bool certifyChapters( const Input& input, std::vector<OutputFile*>& files );

	const PlanOptions& m_options;
	OutputFile m_timed, m_report;
	std::list<CertificateFile> m_certificates; ///< one, until several chapters have one each
	std::string m_certified;                   ///< lines about them
	ViewFile m_view;
	std::vector<Segment> m_segments;
	std::vector<sequence::Chapter> m_chapters;
	std::string m_name, m_told;
	bool m_proved = false;
};

} // namespace leeway::cli
