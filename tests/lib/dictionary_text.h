/* SPDX-License-Identifier: Apache-2.0 */
/* The message table of rt/wire (dictionary.h, signals.h) as texts for people and tools. */
#ifndef FRAY_TESTS_LIB_DICTIONARY_TEXT_H
#define FRAY_TESTS_LIB_DICTIONARY_TEXT_H

#include <stdio.h>

/* A DBC file of instance 0: rt/wire/fray.dbc. */
void dictionary_write_dbc(FILE *out);

/* Two tables, messages and signals: the first block between marks in rt/wire/README.md. */
void dictionary_write_markdown(FILE *out);

/* The table of faults (FRAY_FAULTS of rt/fray.h): the second block of rt/wire/README.md. */
void dictionary_write_faults(FILE *out);

#endif
