/*
 * What the example modules agree on: the messages, the C types of their data,
 * and the formats that describe these types to IPC.
 *
 * The names are those of Appendix A of the IPC Reference Manual.
 */
#ifndef MODULE_H
#define MODULE_H

#define MODULE1_NAME "module1"
#define MODULE2_NAME "module2"
#define MODULE3_NAME "module3"

typedef enum { WaitVal, SendVal, ReceiveVal, ListenVal } STATUS_ENUM;

typedef struct {
    int i1;
    STATUS_ENUM status;
    double matrix[2][3];
    double d1;
} T1_TYPE, *T1_PTR;

/* An enumeration by its largest value: 3 is ListenVal. */
#define T1_NAME "T1"
#define T1_FORMAT "{int, {enum : 3}, [double:2,3], double}"

typedef struct {
    char *str1;
    int count;
    T1_TYPE *t1; /* count elements */
    STATUS_ENUM status;
} T2_TYPE, *T2_PTR;

/* <T1:2> is an array whose length stands in the second member; the enumeration is by names. */
#define T2_NAME "T2"
#define T2_FORMAT "{string, int, <T1:2>, {enum WaitVal, SendVal, ReceiveVal, ListenVal}}"

typedef int MSG1_TYPE, *MSG1_PTR;
#define MSG1 "message1"
#define MSG1_FORMAT "int"

typedef char *MSG2_TYPE, **MSG2_PTR;
#define MSG2 "message2"
#define MSG2_FORMAT "string"

typedef T1_TYPE QUERY1_TYPE, *QUERY1_PTR;
#define QUERY1 "query1"
#define QUERY1_FORMAT T1_NAME

typedef T2_TYPE RESPONSE1_TYPE, *RESPONSE1_PTR;
#define RESPONSE1 "response1"
#define RESPONSE1_FORMAT T2_NAME

#endif
