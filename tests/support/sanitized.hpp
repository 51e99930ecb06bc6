// SPDX-License-Identifier: BSD-3-Clause
// How much a test does: sanitizers are 5 to 20 times slower, and look for other mistakes.
#pragma once

#if defined( __has_feature )
#if __has_feature( address_sanitizer ) || __has_feature( thread_sanitizer )
#define LEEWAY_TESTS_SANITIZED
#endif
#endif
#if defined( __SANITIZE_ADDRESS__ ) || defined( __SANITIZE_THREAD__ )
#define LEEWAY_TESTS_SANITIZED
#endif

/// Rounds of a test, and its expected counts: few under sanitizers.
inline int unlessSanitized( [[maybe_unused]] int many, [[maybe_unused]] int few )
{
#ifdef LEEWAY_TESTS_SANITIZED
	return few;
#else
	return many;
#endif
}
