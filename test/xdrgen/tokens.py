"""Headers as sequences of tokens: what must be the same in two headers that xdrgen makes.

Comments and white space do not count, except that the end of a preprocessor line does.  The block
that defines bool for C is skipped.  A line directive that points into the specification counts as
it is; one that points back into the header only has to be there.
"""
import re

TOKEN = re.compile(r"""
    "(?:\\.|[^"\\\n])*" | '(?:\\.|[^'\\\n])*'
  | \.?\d(?:[eEpP][+-]|[\w.])* | [A-Za-z_]\w*
  | \.\.\.|<<=|>>=|->|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||[-+*/%&|^]=|::|\#\# | \S
""", re.VERBOSE)
COMMENT_OR_LITERAL = re.compile(r"""
    /\*.*?\*/ | //[^\n]* | "(?:\\.|[^"\\\n])*" | '(?:\\.|[^'\\\n])*'
""", re.VERBOSE | re.DOTALL)
LINE_DIRECTIVE = re.compile(r'#\s*(?:line\s+)?(\d+)\s+"([^"]*)"\s*(.*)$')


def without_comments(text):
    """The text with a blank for each comment, and the newlines that were in it."""
    def replace(match):
        found = match.group(0)
        return found if found[0] in "\"'" else " " + "\n" * found.count("\n")
    return COMMENT_OR_LITERAL.sub(replace, text)


def without_bool(lines):
    """The lines outside the conditional block that begins with __xdr_bool."""
    depth = 0
    for line in lines:
        if depth or re.match(r"\s*#\s*if.*__xdr_bool", line):
            depth += bool(re.match(r"\s*#\s*if", line)) - bool(re.match(r"\s*#\s*endif", line))
        else:
            yield line


def of_line(line):
    """The tokens of one line."""
    directive = LINE_DIRECTIVE.match(line.strip())
    if directive:
        number, name = directive.group(1, 2)
        if name.endswith(".h") or name in ("", "<stdout>"):
            return ["#line back"]
        return [f'#line {number} "{name}"']
    return TOKEN.findall(line) + (["<end of line>"] if line.lstrip().startswith("#") else [])


def of(path):
    """The tokens of a header."""
    with open(path, encoding="latin-1", newline="") as file:
        text = without_comments(file.read().replace("\r\n", "\n"))
    return [token for line in without_bool(text.split("\n")) for token in of_line(line)]
