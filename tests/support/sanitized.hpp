// SPDX-License-Identifier: BSD-3-Clause
// How much a test does: sanitizers are 5 to 20 times slower, and look for other mistakes. The build defines LEEWAY_TESTS_SANITIZED, since tests themselves
// are compiled without the address sanitizer.
#pragma once

/// Rounds of a test, and its expected counts: few under sanitizers.
inline int unlessSanitized( [[maybe_unused]] int many, [[maybe_unused]] int few )
{
#ifdef LEEWAY_TESTS_SANITIZED
	return few;
#else
	return many;
#endif
}
