/*
 * The compiler from types to programs.
 *
 * Bodies are compiled one after the other from a list of those that are still
 * wanted; operations name a body by its place in that list until all are there,
 * and then by the index of its first operation.  Every node of the type is
 * compiled once, so a program is never longer than a few times its type.
 */
#include "format/program.h"

#include <stdlib.h>

#include "base/memory.h"
#include "format/type.h"

struct body {
    const struct type *type;
    bool is_element; /* entered for many, so it cannot be the loop of a list */
    uint32_t start;  /* index of the first operation */
};

struct compiler {
    struct program *program;
    enum program_purpose purpose;
    uint32_t n_ops, op_capacity;
    uint32_t n_dimensions, dimension_capacity;
    struct body *bodies;
    uint32_t n_bodies, body_capacity;
    uint32_t current; /* the body that is being compiled */
};

/* Place for one more element; the list doubles. */
static void *make_room(void *list, uint32_t count, uint32_t *capacity, size_t size)
{
    if (count < *capacity) {
        return list;
    }
    *capacity = *capacity == 0 ? 8 : *capacity * 2;
    return mem_resize(list, *capacity, size);
}

static struct op *emit(struct compiler *c, enum opcode code, uint32_t offset)
{
    struct program *program = c->program;
    program->ops = make_room(program->ops, c->n_ops, &c->op_capacity, sizeof *program->ops);
    struct op *op = &program->ops[c->n_ops++];
    memset(op, 0, sizeof *op);
    op->code = (uint8_t)code;
    op->offset = offset;
    return op;
}

static uint32_t want_body(struct compiler *c, const struct type *type, bool is_element)
{
    c->bodies = make_room(c->bodies, c->n_bodies, &c->body_capacity, sizeof *c->bodies);
    c->bodies[c->n_bodies] = (struct body){.type = type, .is_element = is_element};
    return c->n_bodies++;
}

/* The operation before, if it stands in the body that is being compiled. */
static struct op *previous_op(const struct compiler *c)
{
    return c->n_ops > c->bodies[c->current].start ? &c->program->ops[c->n_ops - 1] : NULL;
}

/* Size bytes of numbers of unit bytes at offset, folded into the operation before if that is
 * possible. */
static void emit_run(struct compiler *c, uint32_t offset, uint32_t size, uint32_t unit)
{
    if (size == 0 || c->purpose == PROGRAM_OWNED) {
        return;
    }
    if (c->purpose == PROGRAM_NATIVE) {
        unit = 1;
    }
    const enum opcode code = unit == 1 ? OP_COPY : OP_SWAP;
    struct op *op = previous_op(c);
    if (op == NULL || op->code != code || op->unit != unit ||
        op->offset + op->length * unit != offset) {
        op = emit(c, code, offset);
        op->unit = (uint8_t)unit;
    }
    op->length += size / unit;
}

/* The unit in which a type is one run of numbers for this purpose, or 0 if it is not. */
static uint32_t run_unit(const struct compiler *c, const struct type *type)
{
    if (c->purpose == PROGRAM_OWNED) {
        return type->flat ? 1 : 0;
    }
    if (!type->simple) {
        return 0;
    }
    return c->purpose == PROGRAM_NATIVE ? 1 : type->unit;
}

static void compile_type(struct compiler *c, const struct type *type, uint32_t offset);

static void compile_pointer(struct compiler *c, const struct type *target, uint32_t body,
                            uint32_t offset)
{
    struct op *op = emit(c, OP_POINTER, offset);
    op->size = target->size;
    op->least = target->wire_least;
    op->body = body;
}

static void compile_primitive(struct compiler *c, const struct type *type, uint32_t offset)
{
    switch (type->primitive) {
    case PRIMITIVE_STRING:
        (void)emit(c, OP_STRING, offset);
        break;
    case PRIMITIVE_FORMAT:
        (void)emit(c, OP_FORMAT, offset);
        break;
    case PRIMITIVE_REFERENCE:
        (void)emit(c, OP_REFERENCE, offset);
        break;
    default:
        emit_run(c, offset, type->size, type->unit);
    }
}

static void compile_enumeration(struct compiler *c, const struct type *type, uint32_t offset)
{
    if (type->simple) {
        emit_run(c, offset, type->size, type->unit);
    } else if (c->purpose != PROGRAM_OWNED) {
        emit(c, OP_ENUMERATION, offset)->unit = (uint8_t)type->size;
    }
}

static void compile_fixed_array(struct compiler *c, const struct type *type, uint32_t offset)
{
    const struct type *element = type->members[0];
    const uint32_t unit = run_unit(c, element);
    if (type->size == 0) {
        return;
    }
    if (unit != 0) {
        emit_run(c, offset, type->size, unit);
    } else if (type->count == 1) {
        compile_type(c, element, offset);
    } else {
        uint32_t body = want_body(c, element, true);
        struct op *op = emit(c, OP_LOOP, offset);
        op->length = type->count;
        op->size = element->size;
        op->least = element->wire_least;
        op->body = body;
    }
}

static void add_dimension(struct compiler *c, const struct type *field, uint32_t offset)
{
    struct program *program = c->program;
    program->dimensions = make_room(program->dimensions, c->n_dimensions, &c->dimension_capacity,
                                    sizeof *program->dimensions);
    program->dimensions[c->n_dimensions++] = dimension_of(field, offset);
}

/* The array that is member index of a structure at offset. */
static void compile_variable_array(struct compiler *c, const struct type *structure, uint32_t index,
                                   uint32_t offset)
{
    const struct type *array = structure->members[index];
    const struct type *element = array->members[0];
    const uint32_t unit = element->size == 0 ? 1 : run_unit(c, element);
    const uint32_t body = unit == 0 ? want_body(c, element, true) : 0;
    const uint32_t first_dimension = c->n_dimensions;
    bool follow = false;
    for (uint32_t i = 0; i < array->n_numbers; i++) {
        uint32_t field = reference_index(array->numbers[i]);
        add_dimension(c, structure->members[field], offset + structure->members[field]->offset);
        follow = follow || field > index;
    }
    struct op *op = emit(c, unit != 0 ? OP_BLOCK : OP_ARRAY, offset + array->offset);
    op->unit = (uint8_t)unit;
    op->flat = element->flat;
    op->dimensions_follow = follow;
    op->size = element->size;
    op->least = element->wire_least;
    op->body = body;
    op->first_dimension = first_dimension;
    op->n_dimensions = array->n_numbers;
}

/* Checks of the arrays since operation first whose dimensions followed, the latest array first. */
static void compile_checks(struct compiler *c, const uint32_t *arrays, uint32_t n_arrays)
{
    for (uint32_t i = n_arrays; i > 0; i--) {
        struct op array = c->program->ops[arrays[i - 1]];
        struct op *op = emit(c, OP_CHECK, array.offset);
        op->first_dimension = array.first_dimension;
        op->n_dimensions = array.n_dimensions;
    }
}

/* The members of a structure, but not a self pointer that ends the structure of a whole body. */
static void compile_members(struct compiler *c, const struct type *type, uint32_t n_members,
                            uint32_t offset)
{
    uint32_t *late_arrays = NULL;
    uint32_t n_late = 0, capacity = 0;
    for (uint32_t i = 0; i < n_members; i++) {
        const struct type *member = type->members[i];
        if (member->kind != TYPE_VARIABLE_ARRAY) {
            if (member->kind == TYPE_SELF) {
                compile_pointer(c, type, c->current, offset + member->offset);
            } else {
                compile_type(c, member, offset + member->offset);
            }
            continue;
        }
        compile_variable_array(c, type, i, offset);
        if (!c->program->ops[c->n_ops - 1].dimensions_follow) {
            continue;
        }
        late_arrays = make_room(late_arrays, n_late, &capacity, sizeof *late_arrays);
        late_arrays[n_late++] = c->n_ops - 1;
    }
    if (c->purpose != PROGRAM_OWNED) {
        compile_checks(c, late_arrays, n_late);
    }
    free(late_arrays);
}

static void compile_structure(struct compiler *c, const struct type *type, uint32_t offset)
{
    if (type->has_self) {
        emit(c, OP_CALL, offset)->body = want_body(c, type, false);
    } else {
        compile_members(c, type, type->n_members, offset);
    }
}

static void compile_type(struct compiler *c, const struct type *type, uint32_t offset)
{
    if (c->purpose == PROGRAM_OWNED && type->flat) {
        return;
    }
    switch (type->kind) {
    case TYPE_PRIMITIVE:
        compile_primitive(c, type, offset);
        break;
    case TYPE_RAW:
        emit_run(c, offset, type->size, 1);
        break;
    case TYPE_ENUMERATION:
        compile_enumeration(c, type, offset);
        break;
    case TYPE_STRUCTURE:
        compile_structure(c, type, offset);
        break;
    case TYPE_POINTER: {
        uint32_t body = want_body(c, type->members[0], false);
        compile_pointer(c, type->members[0], body, offset);
        break;
    }
    case TYPE_FIXED_ARRAY:
        compile_fixed_array(c, type, offset);
        break;
    case TYPE_SELF:
    case TYPE_VARIABLE_ARRAY:
        break; /* only in structures, which compile them */
    }
}

static bool ends_with_self(const struct type *type)
{
    return type->members[type->n_members - 1]->kind == TYPE_SELF;
}

static void compile_body(struct compiler *c)
{
    struct body *body = &c->bodies[c->current];
    const struct type *type = body->type;
    const uint32_t start = body->start = c->n_ops;
    if (body->is_element || !type->has_self) {
        compile_type(c, type, 0);
    } else if (!ends_with_self(type)) {
        compile_members(c, type, type->n_members, 0);
    } else {
        const struct type *last = type->members[type->n_members - 1];
        compile_members(c, type, type->n_members - 1, 0);
        struct op *op = emit(c, OP_NEXT, last->offset);
        op->size = type->size;
        op->least = type->wire_least;
        op->body = c->n_ops - 1 - start;
        return;
    }
    struct op *op = emit(c, OP_END, 0);
    op->size = type->size;
    op->body = c->n_ops - 1 - start;
}

/* Turns places in the list of bodies into indexes of operations, and copies into short ones. */
static void finish(struct compiler *c)
{
    for (uint32_t i = 0; i < c->n_ops; i++) {
        struct op *op = &c->program->ops[i];
        if (op->code == OP_COPY && op->length == 4) {
            op->code = OP_COPY_4;
        } else if (op->code == OP_COPY && op->length == 8) {
            op->code = OP_COPY_8;
        }
        if (op->code == OP_POINTER || op->code == OP_ARRAY || op->code == OP_LOOP ||
            op->code == OP_CALL) {
            op->body = c->bodies[op->body].start;
        }
    }
}

void program_compile(struct program *program, const struct type *type, enum program_purpose purpose)
{
    struct compiler compiler = {.program = program, .purpose = purpose};
    program->ops = NULL;
    program->dimensions = NULL;
    (void)want_body(&compiler, type, false);
    while (compiler.current < compiler.n_bodies) {
        compile_body(&compiler);
        compiler.current++;
    }
    finish(&compiler);
    free(compiler.bodies);
}

void program_fini(struct program *program)
{
    free(program->ops);
    free(program->dimensions);
    program->ops = NULL;
    program->dimensions = NULL;
}

struct dimension dimension_of(const struct type *field, uint32_t offset)
{
    const struct type *number = type_first_part(field);
    struct dimension dimension = {.offset = offset, .size = (uint8_t)number->size};
    if (number->kind == TYPE_VARIABLE_ARRAY) {
        dimension.size = 0;
    } else if (number->kind == TYPE_PRIMITIVE) {
        dimension.is_signed = primitive_table[number->primitive].is_signed;
    } else {
        dimension.is_signed = number->size == 4; /* an enumeration */
    }
    return dimension;
}

/* The two's complement or plain value of size bytes in this host's order. */
int64_t dimension_read(const struct dimension *dimension, const uint8_t *element)
{
    const uint8_t *at = element + dimension->offset;
    union {
        uint8_t u1;
        int8_t s1;
        uint16_t u2;
        int16_t s2;
        uint32_t u4;
        int32_t s4;
        uint64_t u8;
        int64_t s8;
    } number;
    memcpy(&number, at, dimension->size);
    switch (dimension->size) {
    case 0:
        return -1;
    case 1:
        return dimension->is_signed ? (int64_t)number.s1 : (int64_t)number.u1;
    case 2:
        return dimension->is_signed ? (int64_t)number.s2 : (int64_t)number.u2;
    case 4:
        return dimension->is_signed ? (int64_t)number.s4 : (int64_t)number.u4;
    default:
        if (dimension->is_signed || number.u8 <= INT64_MAX) {
            return number.s8;
        }
        return INT64_MAX;
    }
}
