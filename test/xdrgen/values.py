"""C programs that check generated headers: made from what --lang=json says of a specification.

For every type there is a function that fills a value with a pattern and one that compares two.
Types that are defined outside the specification (ipc_type) cannot be filled; what contains them is
only measured.
"""

# How a value of a type without parts is made from a running number, and compared.
SCALARS = {
    "char": "(char)(1 + number % 100)",
    "unsigned char": "(unsigned char)(number * 37u)",
    "int": "(int)(number * 1000003u) - 5",
    "unsigned int": "4000000000u - number",
    "float": "(float)number + 0.25f",
    "double": "(double)number / 3.0",
    "bool": "number % 2 != 0",
}
SIZE = 2  # of every dimension of a variable array

PRELUDE = """
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <ipc.h>
#include "{header}"

#ifdef __cplusplus
extern "C"
#endif
int x_ipc_dataStructureSize(FORMATTER_PTR formatter);

static unsigned number = 1;
static int arrived = 0;

static char *new_text(void)
{{
  char text[32];
  number++;
  sprintf(text, "text %u", number);
  return strcpy((char *)malloc(strlen(text) + 1), text);
}}
"""


class Writer:
    """Lines of C for the types of one specification."""

    def __init__(self, description):
        self.types = {each["name"]: each for each in description["types"]}
        self.own = [each for each in description["types"] if each["type"] != "external"]
        self.counter = 0

    def is_closed(self, part):
        """Whether a type holds nothing that is defined elsewhere, nor an empty structure."""
        kind = part["type"]
        if kind in SCALARS or kind == "string" or "values" in part:
            return True
        if "fields" in part:
            return bool(part["fields"]) and all(map(self.is_closed, part["fields"]))
        target = self.types.get(kind)
        return target is not None and target["type"] != "external" and self.is_closed(target)

    def loop(self, bounds, body):
        """Runs body(index expression) over an array with the given dimensions."""
        lines, indices = [], ""
        for bound in bounds:
            self.counter += 1
            name = f"i{self.counter}"
            lines.append(f"for (size_t {name} = 0; {name} < {bound}; {name}++) {{")
            indices += f"[{name}]"
        return lines + body(indices) + ["}"] * len(bounds)

    def fill(self, part, place):
        """Lines that fill what is at a place, a declaration's whole value."""
        if "limits" in part:
            count = SIZE ** len(part["limits"])
            allocate = f"*(void **)&{place} = malloc({count} * sizeof *{place});"
            return [allocate] + self.loop([count], lambda at: self.fill_one(part, place + at))
        bounds = part.get("dimensions", [])
        return self.loop(bounds, lambda at: self.fill_one(part, place + at))

    def fill_one(self, part, place):
        kind = part["type"]
        if "fields" in part:
            sizes = {name for field in part["fields"] for name in field.get("sizes", [])}
            lines = []
            for field in part["fields"]:
                own = f"{place}.{field['name']}"
                if field["name"] in sizes:
                    first = "[0]" * len(field.get("dimensions", []))
                    lines += self.fill(field, own) if first else []
                    lines.append(f"{own}{first} = {SIZE};")
                else:
                    lines += self.fill(field, own)
            return lines
        if "values" in part:
            value = part["values"][-1]["value"]
            return [f"number = {value};", f"memcpy(&{place}, &number, sizeof {place});"]
        if kind == "string":
            return [f"{place} = new_text();"]
        if kind in SCALARS:
            return ["number++;", f"{place} = {SCALARS[kind]};"]
        target = self.types[kind]
        return self.fill(target, place) if "dimensions" in target else self.fill_one(target, place)

    def same(self, part, one, other):
        """Lines that return from the function when two values differ."""
        if "limits" in part:
            bounds = [SIZE ** len(part["limits"])]
        else:
            bounds = part.get("dimensions", [])
        return self.loop(bounds, lambda at: self.same_one(part, one + at, other + at))

    def same_one(self, part, one, other):
        if "fields" in part:
            return [line for field in part["fields"]
                    for line in self.same(field, f"{one}.{field['name']}",
                                          f"{other}.{field['name']}")]
        if part["type"] == "string":
            return [f"if (strcmp({one}, {other}) != 0) return 0;"]
        if "values" in part or part["type"] in SCALARS:
            return [f"if (memcmp(&{one}, &{other}, sizeof {one}) != 0) return 0;"]
        return self.same(self.types[part["type"]], one, other)


def sizes_function(writer):
    """A function that prints for every type: its name, sizeof, and the size IPC computes."""
    lines = ["static void print_sizes(void)", "{", "IPC_initialize();"]
    for each in writer.own:
        name = each["name"]
        lines.append(f'printf("{name} %d %d\\n", (int)sizeof({name}), '
                     f"x_ipc_dataStructureSize(IPC_parseFormat({name}_IPC_FORMAT)));")
    return lines + ["}"]


def journey_functions(writer, each):
    """A function that marshalls and unmarshalls, then publishes to itself, a value of a type."""
    name = each["name"]
    return [f"static {name} sent_{name};",
            f"static void fill_{name}(void)", "{", *writer.fill(each, f"sent_{name}"), "}",
            f"static int same_{name}({name} *other_)", "{",
            *writer.same(each, f"sent_{name}", "(*other_)"), "return 1;", "}",
            f"static void on_{name}(MSG_INSTANCE message, void *data, void *client)", "{",
            "(void)client;", f"arrived += same_{name}(({name} *)data);",
            "IPC_freeData(IPC_msgInstanceFormatter(message), data);", "}",
            f"static void try_{name}(void)", "{",
            f"FORMATTER_PTR format = IPC_parseFormat({name}_IPC_FORMAT);",
            "IPC_VARCONTENT_TYPE content;", "void *copy = NULL;", f"fill_{name}();",
            f"if (IPC_marshall(format, &sent_{name}, &content) != IPC_OK ||",
            "IPC_unmarshall(format, content.content, &copy) != IPC_OK ||",
            f'!same_{name}(({name} *)copy)) printf("{name} is not the same\\n");',
            "IPC_freeByteArray(content.content);", "IPC_freeData(format, copy);",
            "arrived = 0;",
            f'IPC_defineMsg("{name}", IPC_VARIABLE_LENGTH, {name}_IPC_FORMAT);',
            f'IPC_subscribeData("{name}", on_{name}, NULL);',
            f'IPC_publishData("{name}", &sent_{name});',
            "for (int tries = 0; arrived == 0 && tries < 10; tries++) IPC_listen(1000);",
            f'if (arrived != 1) printf("{name} has not arrived\\n");', "}"]


def program(header, description):
    """A program that prints sizes; with an argument, it lets values of all types travel instead."""
    writer = Writer(description)
    closed = [each for each in writer.own if writer.is_closed(each)]
    lines = [PRELUDE.format(header=header), *sizes_function(writer)]
    for each in closed:
        lines += journey_functions(writer, each)
    lines += ["int main(int n_arguments, char **arguments)", "{",
              "(void)new_text; (void)arguments; (void)arrived;",
              "if (n_arguments == 1) { print_sizes(); return 0; }",
              'if (IPC_connect("traveller") != IPC_OK) return 1;']
    lines += [f"try_{each['name']}();" for each in closed]
    return "\n".join(lines + [f'printf("{len(closed)} types\\n");', "IPC_disconnect();",
                              "return 0;", "}", ""])
