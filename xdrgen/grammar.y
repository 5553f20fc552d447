/*
 * The grammar of specifications.
 *
 * Each action is one call into the tree.  Behind a syntax error the parser goes
 * on after the next semicolon, skipping what stands in braces until there, or
 * at the end of the structure or enum it is in.
 */
%code requires {
#include "parse.h"
#include "tree.h"
}

%define api.pure full
%define api.prefix {xdr_}
%define api.token.prefix {TOKEN_}
%define api.location.type {struct place}
%define parse.error custom
%locations
%expect 0
%param { void *scanner }
%parse-param { struct parse *parse }

%union {
    struct text text;
    struct type type;
    struct declaration *declaration;
    struct dimension dimension;
    struct dimensions *dimensions;
    struct record *record;
    struct enumeration *enumeration;
    struct enumerator enumerator;
}

%token END 0 "end of file"
%token <text> IDENTIFIER LONGVAL STRINGVAL PASS_THROUGH_CODE
%token BOOL CHAR DOUBLE ENUM FLOAT INT IPC_TYPE OPAQUE STRING STRUCT TYPEDEF UNSIGNED VOID
%token LONG SHORT UNSUPPORTED

%type <type> specifier
%type <declaration> declaration field
%type <dimension> fixed_dimension variable_dimension
%type <dimensions> fixed_dimensions variable_dimensions
%type <record> record fields
%type <enumeration> enumeration enumerators
%type <enumerator> enumerator

%destructor { type_fini(&$$); } <type>
%destructor { declaration_free($$); } <declaration>
%destructor { dimensions_free($$); } <dimensions>
%destructor { record_free($$); } <record>
%destructor { enumeration_free($$); } <enumeration>

%code provides {
int xdr_lex(XDR_STYPE *value, XDR_LTYPE *place, void *scanner);
}

%code {
/* A rule stands where its first part does. */
#define YYLLOC_DEFAULT(Current, Rhs, N) ((Current) = (N) > 0 ? YYRHSLOC(Rhs, 1) : YYRHSLOC(Rhs, 0))

/* Enough for TREE_MAX_DEPTH structures in one another; places can be moved as bytes. */
#define YYMAXDEPTH 20000
#define XDR_LTYPE_IS_TRIVIAL 1

static void xdr_error(const struct place *place, void *scanner, struct parse *parse,
                      const char *message);

static struct dimension dimension_of(const struct place *place, const struct text *number);
static struct enumerator enumerator_of(struct text name, const struct place *place,
                                       const struct text *number);
}

%%

specification:
    %empty
  | specification definition
;

definition:
    TYPEDEF declaration ';'              { tree_add_type(parse->tree, $2); }
  | STRUCT IDENTIFIER record ';'         { tree_add_type(parse->tree, declaration_new(
                                               parse_record(parse, $3, &@1), $2, &@2, ARRAY_NONE,
                                               NULL)); }
  | ENUM IDENTIFIER enumeration ';'      { tree_add_type(parse->tree, declaration_new(
                                               type_enum($3, &@1), $2, &@2, ARRAY_NONE, NULL)); }
  | IPC_TYPE IDENTIFIER ';'              { tree_add_format(parse->tree, $2, &@2, NULL); }
  | IPC_TYPE IDENTIFIER '=' STRINGVAL ';' { tree_add_format(parse->tree, $2, &@2,
                                                scan_string_value($4)); }
  | PASS_THROUGH_CODE                    { tree_add_code(parse->tree, $1, &@1); }
  | error ';'                            { yyerrok; }
  | error skipped rest ';'               { yyerrok; }
;

declaration:
    specifier IDENTIFIER                 { $$ = declaration_new($1, $2, &@2, ARRAY_NONE, NULL); }
  | specifier IDENTIFIER fixed_dimensions
                                         { $$ = declaration_new($1, $2, &@2, ARRAY_FIXED, $3); }
  | specifier IDENTIFIER variable_dimensions
                                         { $$ = declaration_new($1, $2, &@2, ARRAY_VARIABLE, $3); }
  | STRING IDENTIFIER variable_dimensions
                                         { $$ = declaration_new_string(&@1, $2, &@2,
                                                ARRAY_VARIABLE, $3); }
  | STRING IDENTIFIER fixed_dimensions variable_dimension
                                         { dimensions_append($3, $4);
                                           $$ = declaration_new_string(&@1, $2, &@2,
                                                ARRAY_FIXED, $3); }
;

fixed_dimensions:
    fixed_dimension                      { $$ = dimensions_new(); dimensions_append($$, $1); }
  | fixed_dimensions fixed_dimension     { $$ = $1; dimensions_append($$, $2); }
;

fixed_dimension:
    '[' LONGVAL ']'                      { $$ = dimension_of(&@2, &$2); }
;

variable_dimensions:
    variable_dimension                   { $$ = dimensions_new(); dimensions_append($$, $1); }
  | variable_dimensions variable_dimension
                                         { $$ = $1; dimensions_append($$, $2); }
;

variable_dimension:
    '<' '>'                              { $$ = dimension_of(&@1, NULL); }
  | '<' LONGVAL '>'                      { $$ = dimension_of(&@2, &$2); }
;

specifier:
    INT                                  { $$ = type_simple(TYPE_INT, &@1); }
  | UNSIGNED INT                         { $$ = type_simple(TYPE_UINT, &@1); }
  | FLOAT                                { $$ = type_simple(TYPE_FLOAT, &@1); }
  | DOUBLE                               { $$ = type_simple(TYPE_DOUBLE, &@1); }
  | BOOL                                 { $$ = type_simple(TYPE_BOOL, &@1); }
  | CHAR                                 { $$ = type_simple(TYPE_CHAR, &@1); }
  | UNSIGNED CHAR                        { $$ = type_simple(TYPE_UCHAR, &@1); }
  | OPAQUE                               { $$ = type_simple(TYPE_UCHAR, &@1); }
  | STRUCT record                        { $$ = parse_record(parse, $2, &@1); }
  | ENUM enumeration                     { $$ = type_enum($2, &@1); }
  | IDENTIFIER                           { $$ = type_named($1, &@1); }
;

record:
    '{' fields '}'                       { $$ = $2; }
  | '{' fields PASS_THROUGH_CODE '}'     { $$ = $2; $$->code = (struct code){$3, @3}; }
  | '{' VOID ';' '}'                     { $$ = record_new(); }
  | '{' VOID ';' PASS_THROUGH_CODE '}'   { $$ = record_new(); $$->code = (struct code){$4, @4}; }
  | '{' error '}'                        { $$ = record_new(); record_append($$, NULL); yyerrok; }
  | '{' fields error '}'                 { $$ = $2; record_append($$, NULL); yyerrok; }
;

fields:
    field                                { $$ = record_new(); record_append($$, $1); }
  | fields field                         { $$ = $1; record_append($$, $2); }
;

field:
    declaration ';'                      { $$ = $1; }
  | error ';'                            { $$ = NULL; yyerrok; }
  | error skipped rest ';'               { $$ = NULL; yyerrok; }
;

enumeration:
    '{' enumerators '}'                  { $$ = $2; }
  | '{' error '}'                        { $$ = enumeration_new(); yyerrok; }
  | '{' enumerators error '}'            { $$ = $2; yyerrok; }
;

enumerators:
    enumerator                           { $$ = enumeration_new(); enumeration_append($$, $1); }
  | enumerators ',' enumerator           { $$ = $1; enumeration_append($$, $3); }
;

enumerator:
    IDENTIFIER                           { $$ = enumerator_of($1, &@1, NULL); }
  | IDENTIFIER '=' LONGVAL               { $$ = enumerator_of($1, &@1, &$3); }
;

/* What stands in braces behind a syntax error. */
skipped:
    '{' tokens '}'
;

tokens:
    %empty
  | tokens word
  | tokens ';'
  | tokens skipped
;

rest:
    %empty
  | rest word
;

word:
    IDENTIFIER | LONGVAL | STRINGVAL | PASS_THROUGH_CODE
  | BOOL | CHAR | DOUBLE | ENUM | FLOAT | INT | IPC_TYPE | OPAQUE | STRING | STRUCT | TYPEDEF
  | UNSIGNED | VOID | LONG | SHORT | UNSUPPORTED
  | '[' | ']' | '<' | '>' | '(' | ')' | '.' | ',' | ':' | '='
;

%%

/* Called when the parser's stack is full. */
static void xdr_error(const struct place *place, void *scanner, struct parse *parse,
                      const char *message)
{
    (void)scanner;
    (void)message;
    parse_report_depth(parse, place);
}

static int yyreport_syntax_error(const yypcontext_t *context, void *scanner, struct parse *parse)
{
    enum { MOST = 4 };
    yysymbol_kind_t kinds[MOST];
    const char *names[MOST];
    const int count = yypcontext_expected_tokens(context, kinds, MOST);
    for (int i = 0; i < count; i++)
        names[i] = yysymbol_name(kinds[i]);
    (void)scanner;
    parse_report_unexpected(parse, yypcontext_location(context),
                            yysymbol_name(yypcontext_token(context)), names, count);
    return 0;
}

static struct dimension dimension_of(const struct place *place, const struct text *number)
{
    struct dimension dimension = {.place = *place, .has_value = number != NULL, .width = 1};
    if (number != NULL) {
        dimension.value = text_number(*number);
        dimension.width = number->length;
    }
    return dimension;
}

static struct enumerator enumerator_of(struct text name, const struct place *place,
                                       const struct text *number)
{
    struct enumerator enumerator = {.name = name, .place = *place, .has_value = number != NULL};
    if (number != NULL)
        enumerator.value = text_number(*number);
    return enumerator;
}
