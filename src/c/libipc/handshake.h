/*
 * The handshake with central.
 *
 * A state machine: each step does what can be done with what has arrived, and none
 * waits.  Who connects for the first time waits between the steps (connect.c); who
 * has lost central goes on with other things meanwhile (reconnect.c).
 */
#ifndef IPC_LIBIPC_HANDSHAKE_H
#define IPC_LIBIPC_HANDSHAKE_H

#include "libipc/context.h"

/* Names that are asked for only to say that this library has the ability. */
enum { N_ABILITIES = 2 };

/* Something that central has been asked in the present stage. */
struct question {
    struct awaited awaited;
    int32_t *number; /* where the answer to a look-up goes; NULL: nowhere, or no look-up */
};

enum { MAX_QUESTIONS = LM_COUNT + N_ABILITIES + 1 };

enum handshake_stage {
    HANDSHAKE_GREETING,     /* central greets */
    HANDSHAKE_NUMBERS,      /* the numbers of all messages that are needed have been asked for */
    HANDSHAKE_INTRODUCTION, /* this module has said who it is */
    HANDSHAKE_DIRECT_PORT,  /* the number for telling where others reach it has been asked for */
    HANDSHAKE_READY,        /* central has been told everything, and that the module is ready */
    HANDSHAKE_OVER
};

enum handshake_result {
    HANDSHAKE_GOES_ON, /* more has to arrive */
    HANDSHAKE_DONE,    /* the context may be called connected */
    HANDSHAKE_BROKEN,  /* the connection has gone, or the time for it is over */
    HANDSHAKE_MISMATCH /* central speaks another major version */
};

struct handshake {
    struct _X_IPC_CONTEXT *context;
    enum handshake_stage stage;
    uint64_t deadline_ns;
    int32_t get_broadcasts; /* number of the query for the list of broadcasts, 0: none */
    struct question questions[MAX_QUESTIONS];
    int n_questions;
};

/* Begins over the context's link, which is new; the context is in state connecting. */
void handshake_init(struct handshake *handshake, struct _X_IPC_CONTEXT *context);

/* Frees what the answers held.  May be called again. */
void handshake_fini(struct handshake *handshake);

/* Goes on as far as it can. */
enum handshake_result handshake_step(struct handshake *handshake);

#endif
