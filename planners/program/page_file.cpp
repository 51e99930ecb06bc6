// SPDX-License-Identifier: BSD-3-Clause
// Pages of results: see page_file.hpp.
#include "program/page_file.hpp"

#include <utility>

namespace leeway::cli
{

ViewFile::ViewFile( const std::string& path )
{
	if ( !path.empty() )
	{
		requireView( "--view" );
		m_file.emplace( "--view", path );
	}
}

void ViewFile::write( PageInput page, std::vector<OutputFile*>& files )
{
	Progress progress( "writing the page" );
	page.progress = shownBy( progress );
	m_file->text = pageHtml( page );
	files.push_back( &*m_file );
}

PageInput pageOf( const Input& input, const io::Problem& problem, ViewMotion motion, lw_check_flags flags )
{
	PageInput page = { input.robot, input.scene ? &*input.scene : nullptr, problem, std::move( motion ), flags };
	page.robot_file = input.robot_file;
	page.scene_file = input.scene_file;
	return page;
}

} // namespace leeway::cli
