// The controls of text, arrows, trails and plots, and the same in the address.

const FLAGS = ["clock", "scale", "label"];
const ARROWS = ["velocity", "force", "gravity"];

// Fills the controls from the address and calls `show` with what is wanted, at once and after every change.
export function connectMarks(find, query, show) {
    const part = name => find(`mark-${name}`);
    part("title").value = query.get("title") ?? "";
    part("arrows").value = ARROWS.includes(query.get("arrows")) ? query.get("arrows") : "";
    part("trails").value = `${Math.min(100, Number(query.get("trails")) || 0)}`;
    part("plot").value = query.getAll("plot").join(" ");
    for (const flag of FLAGS) part(flag).checked = query.has(flag);
    const wanted = () => ({
        title: part("title").value.trim(),
        ...Object.fromEntries(FLAGS.map(flag => [flag, part(flag).checked])),
        arrows: part("arrows").value,
        trails: Math.max(0, Math.min(100, Number(part("trails").value) || 0)),
        plots: part("plot").value.split(/\s+/).filter(text => text),
    });
    for (const name of [...FLAGS, "title", "arrows", "trails", "plot"]) part(name).addEventListener("change", () => show(wanted()));
    show(wanted());
}

// The query of the address with what is wanted.
export function marksQuery(search, wanted) {
    const query = new URLSearchParams(search);
    for (const name of [...FLAGS, "title", "arrows", "trails", "plot"]) query.delete(name);
    for (const flag of FLAGS) if (wanted[flag]) query.set(flag, "");
    for (const name of ["title", "arrows", "trails"]) if (wanted[name]) query.set(name, `${wanted[name]}`);
    for (const plot of wanted.plots) query.append("plot", plot);
    const text = query.toString();
    return text ? `?${text}` : "";
}
