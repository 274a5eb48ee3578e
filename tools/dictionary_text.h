/* SPDX-License-Identifier: Apache-2.0 */
/* The message table of rt/wire (dictionary.h, signals.h) as texts for people and tools. */
#ifndef FRAY_TOOLS_DICTIONARY_TEXT_H
#define FRAY_TOOLS_DICTIONARY_TEXT_H

#include <stdio.h>

/* A DBC file of instance 0: rt/wire/fray.dbc. */
void dictionary_write_dbc(FILE *out);

/* Two tables, messages and signals: what is between the marks in rt/wire/README.md. */
void dictionary_write_markdown(FILE *out);

#endif
