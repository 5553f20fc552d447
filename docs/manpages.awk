# Makes manual pages of the Markdown of these documents.
#
#   awk -v section=3 -v version=4.0.0 -v directory=DIR -f manpages.awk FILE...
#       writes DIR/NAME.3 for each entry "## NAME" of the files;
#   awk -v section=7 -v version=4.0.0 -v directory=DIR -v page=ipc -f manpages.awk FILE
#       writes DIR/ipc.7, the whole file with "## ..." as its sections.
#
# The first paragraph of a page is one sentence, which says what it is about; of an
# entry, the first block of code is its synopsis.  A paragraph that begins with
# "**Word:**" begins a section.  Understood besides: paragraphs, lists, tables, blocks of
# code, `code`, **bold**, *italics* and [links](to), the last without their targets.

# ------------------------------------------------------------------- text

# Text that is shown as it is.
function literal(text) {
    gsub(/\\/, "\\e", text)
    gsub(/-/, "\\-", text)
    return text
}

# Text between marks of that kind, given the commands that begin and end its font.
function marked(text, mark, width, begin, end,    result) {
    result = ""
    while (match(text, mark)) {
        result = result substr(text, 1, RSTART - 1) begin \
                 substr(text, RSTART + width, RLENGTH - 2 * width) end
        text = substr(text, RSTART + RLENGTH)
    }
    return result text
}

# Text without code in it.
function plain(text,    result, link) {
    result = ""
    while (match(text, /\[[^]]*\]\([^)]*\)/)) {
        link = substr(text, RSTART + 1, RLENGTH - 2)
        result = result substr(text, 1, RSTART - 1) substr(link, 1, index(link, "](") - 1)
        text = substr(text, RSTART + RLENGTH)
    }
    text = result text
    gsub(/\\/, "\\e", text)
    text = marked(text, "[*][*][^*]+[*][*]", 2, "\\fB", "\\fP")
    return marked(text, "[*][^* ][^*]*[*]", 1, "\\fI", "\\fP")
}

# A line of text with its fonts.
function inline(text,    parts, n, i, result) {
    result = ""
    n = split(text, parts, "`")
    for (i = 1; i <= n; i++) {
        result = result (i % 2 == 1 ? plain(parts[i]) : "\\fB" literal(parts[i]) "\\fP")
    }
    return result
}

# A line that must not be taken for a command.
function put(line) {
    if (line ~ /^[.']/) {
        line = "\\&" line
    }
    print line > output
}

function put_command(line) {
    print line > output
}

# ------------------------------------------------------------------ pages

function begin_page(name) {
    end_page()
    output = directory "/" name "." section
    page_name = name
    awaited = "summary"
    put_command("'\\\" t")
    put_command(".TH " toupper(name) " " section " \"\" \"IPC " version "\" \"IPC\"")
    put_command(".nh\n.ad l")
}

function end_page(    i, others) {
    end_block()
    if (output == "") {
        return
    }
    if (page == "") {
        others = ""
        for (i = 1; i <= n_entries; i++) {
            if (entries[i] != page_name) {
                others = others "\\fB" entries[i] "\\fP(" section "),\n"
            }
        }
        begin_section("SEE ALSO")
        put(others "\\fBipc\\fP(7)")
    }
    close(output)
    output = ""
}

function begin_section(title) {
    put_command(".SH " title)
    awaited = ""
}

# What comes next is not the summary or the synopsis any more.
function begin_text() {
    if (awaited == "synopsis" || awaited == "text") {
        begin_section("DESCRIPTION")
    }
}

# The names of the entries of a file, for what they say about each other.
function find_entries(file,    line) {
    n_entries = 0
    while ((getline line < file) > 0) {
        if (line ~ /^## /) {
            entries[++n_entries] = substr(line, 4)
        }
    }
    close(file)
}

# ----------------------------------------------------------------- blocks

# Ends the paragraph, the item of a list or the table that is being read.
function end_block() {
    if (n_rows > 0) {
        put_table()
    } else if (paragraph != "" && output != "") {
        put_paragraph(paragraph)
    }
    paragraph = ""
}

function put_paragraph(text) {
    if (awaited == "summary") {
        put_summary(text)
    } else if (match(text, /^[*][*][A-Z][A-Za-z ]*:[*][*]/)) {
        begin_section(toupper(substr(text, 3, RLENGTH - 5)))
        put_text(substr(text, RLENGTH + 2))
    } else {
        begin_text()
        put_item(text)
    }
}

function put_summary(text) {
    sub(/[.]$/, "", text)
    begin_section("NAME")
    put(page_name " \\- " inline(tolower(substr(text, 1, 1)) substr(text, 2)))
    awaited = page == "" ? "synopsis" : "text"
}

# An item of a list, or a paragraph.
function put_item(text,    length_of_mark) {
    if (match(text, /^- `[^`]*`: /)) {
        length_of_mark = RLENGTH
        put_command(".TP")
        put_text(substr(text, 3, length_of_mark - 4))
    } else if (match(text, /^- /)) {
        length_of_mark = RLENGTH
        put_command(".IP \\(bu 2")
    } else if (match(text, /^[0-9]+[.] /)) {
        length_of_mark = RLENGTH
        put_command(".IP " substr(text, 1, length_of_mark - 1) " 4")
    } else {
        length_of_mark = 0
        put_command(".PP")
    }
    put_text(substr(text, length_of_mark + 1))
}

function put_text(text) {
    if (text != "") {
        put(inline(text))
    }
}

# A table is shown by tbl; columns with long texts share the width that is left.
function put_table(    i, j, n, cells, widths, layout, columns) {
    begin_text()
    columns = 0
    for (i = 1; i <= n_rows; i++) {
        n = split(rows[i], cells, "\t")
        columns = n > columns ? n : columns
        for (j = 1; j <= n; j++) {
            if (length(cells[j]) > widths[j]) {
                widths[j] = length(cells[j])
            }
        }
    }
    layout = ""
    for (j = 1; j <= columns; j++) {
        layout = layout (j > 1 ? " " : "") (widths[j] > 24 ? "lx" : "l")
    }
    put_command(".PP\n.TS\ntab(\t);\n" layout ".")
    for (i = 1; i <= n_rows; i++) {
        n = split(rows[i], cells, "\t")
        for (j = 1; j <= columns; j++) {
            printf "%sT{\n%s\nT}", (j > 1 ? "\t" : ""), \
                   (i == 1 ? "\\fI" cells[j] "\\fP" : inline(cells[j])) > output
        }
        put_command("")
    }
    put_command(".TE")
    n_rows = 0
}

# A row of a table, its cells separated by tabs; bars in code are written \|.
function row(line) {
    gsub(/\\[|]/, "\001", line)
    sub(/^[|] */, "", line)
    sub(/ *[|] *$/, "", line)
    gsub(/ *[|] */, "\t", line)
    gsub(/\001/, "|", line)
    return line
}

function begin_code() {
    if (awaited == "synopsis") {
        begin_section("SYNOPSIS")
        put_command(".nf")
        put("#include <ipc/" (page_name ~ /^IPC_/ ? "ipc" : "ipcx") ".h>")
        put_command(".PP")
        awaited = "text"
    } else {
        begin_text()
        put_command(".PP\n.in +4n\n.nf")
        indented = 1
    }
}

function end_code() {
    put_command(".fi")
    if (indented) {
        put_command(".in")
        indented = 0
    }
}

# ------------------------------------------------------------------ lines

FNR == 1 {
    end_page()
    in_code = 0
    find_entries(FILENAME)
    if (page != "") {
        begin_page(page)
    }
}

/^```/ {
    end_block()
    in_code = !in_code
    if (output != "") {
        if (in_code) {
            begin_code()
        } else {
            end_code()
        }
    }
    next
}

in_code {
    if (output != "") {
        put(literal($0))
    }
    next
}

/^# / { next }

/^## / {
    end_block()
    if (page == "") {
        begin_page(substr($0, 4))
    } else {
        begin_section(toupper(plain(substr($0, 4))))
    }
    next
}

/^### / {
    end_block()
    put_command(".SS " plain(substr($0, 5)))
    next
}

/^$/ {
    end_block()
    next
}

output == "" { next }

/^[|]/ {
    if ($0 !~ /^[|][-| ]*$/) {
        rows[++n_rows] = row($0)
    }
    next
}

/^- |^[0-9]+\. / {
    end_block()
    paragraph = $0
    next
}

{
    line = $0
    sub(/^ +/, "", line)
    paragraph = paragraph == "" ? line : paragraph " " line
}

END { end_page() }
