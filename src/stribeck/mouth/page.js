const copy = document.getElementById("copy");
if (copy) {
  copy.hidden = false;
  copy.onclick = async () => {
    try { await navigator.clipboard.writeText(copy.dataset.command); copy.textContent = "copied"; } catch { copy.textContent = copy.dataset.command; }
  };
}
const within = (a) => { const row = a?.closest("ol"); if (row && row.scrollWidth > row.clientWidth) row.scrollLeft = a.offsetLeft - row.offsetLeft - 20; };
const links = new Map([...document.querySelectorAll("nav a")].map((a) => [a.hash.slice(1), a]));
const sections = [...document.querySelectorAll("section")], read = new Set(); // those in the upper third, where one reads
const seen = new IntersectionObserver((entries) => {
  for (const { isIntersecting, target } of entries) isIntersecting ? read.add(target) : read.delete(target);
  const here = sections.find((section) => read.has(section)); // below the end of the one before, which a link leaves in sight
  if (here) { for (const [id, a] of links) a.classList.toggle("here", id === here.id); within(links.get(here.id)); }
}, { rootMargin: "-64px 0px -70% 0px" });
sections.forEach((section) => seen.observe(section));
