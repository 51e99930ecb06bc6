// SPDX-License-Identifier: BSD-3-Clause
// Exponential back-off of a test that costs time and only sometimes saves more: after failures in a row it runs less often.
// Only speed depends on it.
#ifndef LEEWAY_BASE_BACKOFF_H
#define LEEWAY_BASE_BACKOFF_H

#include <stdbool.h>
#include <stdint.h>

/// Zeroed: the next call runs the test.
typedef struct lwi_backoff
{
	uint8_t failures; ///< in a row, as far as they count
	uint8_t wait;     ///< calls until the test runs again
} lwi_backoff;

/// True if the test may run now, else the wait gets one call shorter. The caller reports the outcome of a test that ran.
static inline bool lwi_backoff_is_due( lwi_backoff* backoff )
{
	if ( backoff->wait == 0 )
	{
		return true;
	}
	--backoff->wait;
	return false;
}

static inline void lwi_backoff_succeeded( lwi_backoff* backoff )
{
	backoff->failures = 0;
}

/// After n failures in a row the test waits for 2^n - grace calls.
/// @param most failures that count, at most 7 @param grace at most 2
static inline void lwi_backoff_failed( lwi_backoff* backoff, uint32_t most, uint32_t grace )
{
	backoff->failures = (uint8_t)( backoff->failures < most ? backoff->failures + 1u : most );
	backoff->wait = (uint8_t)( ( 1u << backoff->failures ) - grace );
}

#endif
