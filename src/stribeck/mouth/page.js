const copy = document.getElementById("copy");
if (copy) {
  copy.hidden = false;
  copy.onclick = async () => {
    try { await navigator.clipboard.writeText(copy.dataset.command); copy.textContent = "copied"; } catch { copy.textContent = copy.dataset.command; }
  };
}
const within = (a) => { const row = a?.closest("ol"); if (row && row.scrollWidth > row.clientWidth) row.scrollLeft = a.offsetLeft - row.offsetLeft - 20; };
const links = new Map([...document.querySelectorAll("nav a")].map((a) => [a.hash.slice(1), a]));
const seen = new IntersectionObserver((entries) => {
  for (const { isIntersecting, target } of entries) if (isIntersecting) { for (const [id, a] of links) a.classList.toggle("here", id === target.id); within(links.get(target.id)); }
}, { rootMargin: "0px 0px -70% 0px" });
document.querySelectorAll("section").forEach((section) => seen.observe(section));
