/* SPDX-License-Identifier: Apache-2.0
 * Copyright Contributors to the cg2raw Project.
 *
 * LD_PRELOAD: makes a call fail, of files of one folder, or for memory. Environment:
 *   FAULT_UNDER   the folder; files elsewhere, pipes and sockets are left alone
 *   FAULT_CALL    one of CALLS of injector.py
 *   FAULT_ERRNO   what it fails with; not said of short reads and writes, nor of malloc
 *   FAULT_NTH     which of these calls in a process fails, from 1 on
 *   FAULT_STICKY  1: and all after it
 *   FAULT_NO_TMPFILE  1: the file system knows no files without a name
 *   FAULT_LOG     a file that gets a byte when a call was made to fail
 *   FAULT_SERVER  1: a program forks before main() for each line of standard input, of
 *                 the five settings from FAULT_CALL on, and prints two lines: the
 *                 process, and how it ended, as waitpid() says
 */
#pragma once

#ifdef __cplusplus
extern "C" {
#endif

/* Takes "CALL ERRNO NTH STICKY NO_TMPFILE" for the settings, and counts anew. */
void fault_begin(const char* words);

/* Whether this call is the one that is asked for, of any number. */
int fault_is_asked(const char* call);

/* Whether this call, which is asked for, is to fail; sets errno then. */
int fault_strikes(void);

#ifdef __cplusplus
}
#endif
