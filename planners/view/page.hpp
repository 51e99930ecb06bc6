// SPDX-License-Identifier: BSD-3-Clause
// The page of `leeway view`, and pictures of it.
#pragma once

#include "view/content.hpp"

#include <string>
#include <vector>

namespace leeway::view
{

/// Why this build writes no pages; empty if it does.
std::string viewProblem();

/// @throws io::Error if this build writes no pages
void requireView( const std::string& option );

/// The page as HTML.
/// @param chapters one, or several worlds of which the page shows one at a time, played one after the other
/// @throws io::Error, CoreError
std::string pageHtml( const std::vector<const PageInput*>& chapters );

/// A picture of a page.
struct PictureOptions
{
	std::string file;   ///< PNG
	std::string camera; ///< AZIMUTH,ELEVATION[,DISTANCE]: degrees, degrees, metres; empty: chosen by the page
	std::string at;     ///< place of the motion, or "least"; empty: its start
	unsigned width = 1280, height = 800;
};

/// Draws a page by a headless Chromium. @param html of pageHtml()
/// @throws io::Error if no browser is found ($LEEWAY_BROWSER, chromium, google-chrome), or it draws nothing
std::string pagePicture( const std::string& html, const PictureOptions& options );

} // namespace leeway::view
