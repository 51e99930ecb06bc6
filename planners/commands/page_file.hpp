// SPDX-License-Identifier: BSD-3-Clause
// Pages of results: --view of the subcommands.
#pragma once

#include "program/setup.hpp"
#include "view/page.hpp"

#include <optional>
#include <string>
#include <vector>

namespace leeway::cli
{

/// The page of a subcommand's result: --view.
class ViewFile
{
public:
	/// @throws io::Error if this build writes no pages, or the file cannot be written
	explicit ViewFile( const std::string& path );
	bool isWanted() const { return m_file.has_value(); }
	/// Writes the page into a file that is committed with the others.
	void write( PageInput page, std::vector<OutputFile*>& files );
	/// The same of several worlds, which are played one after the other.
	void write( std::vector<PageInput> chapters, std::vector<OutputFile*>& files );

private:
	std::optional<OutputFile> m_file;
};

/// A page on the files of the run.
PageInput pageOf( const Input& input, const io::Problem& problem, ViewMotion motion, lw_check_flags flags );

} // namespace leeway::cli
