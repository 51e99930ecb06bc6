// SPDX-License-Identifier: BSD-3-Clause
// The page of `leeway view`, and pictures of it.
#pragma once

#include "program/options.hpp"
#include "view/content.hpp"

#include <optional>
#include <string>
#include <vector>

namespace leeway::cli
{

/// Why this build writes no pages; empty if it does.
std::string viewProblem();

/// @throws io::Error if this build writes no pages
void requireView( const std::string& option );

/// The page as HTML.
/// @throws io::Error, CoreError
std::string pageHtml( const PageInput& page );

/// The page of a subcommand's result: --view.
class ViewFile
{
public:
	/// @throws io::Error if this build writes no pages, or the file cannot be written
	explicit ViewFile( const std::string& path );
	bool isWanted() const { return m_file.has_value(); }
	/// Writes the page into a file that is committed with the others.
	void write( const PageInput& page, std::vector<OutputFile*>& files );

private:
	std::optional<OutputFile> m_file;
};

/// Draws a page by a headless Chromium. @param html of pageHtml()
/// @throws io::Error if no browser is found ($LEEWAY_BROWSER, chromium, google-chrome), or it draws nothing
std::string pagePicture( const std::string& html, const PictureOptions& options );

} // namespace leeway::cli
