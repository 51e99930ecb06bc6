// SPDX-License-Identifier: BSD-3-Clause
// Attributes and sections that MJCF has: a misspelt one would be silently without effect.
#pragma once

#include "mjcf/document.hpp"

namespace leeway::io::detail::mjcf
{

/// One notice with all attributes and sections that MJCF does not know, with their lines.
void noticeUnknown( const Document& document, std::vector<Notice>& notices );

} // namespace leeway::io::detail::mjcf
