# Links of Markdown for Doxygen: [text](page.md#heading) becomes [text](page.md), [text](#heading) becomes text
s/\]\(([^)#]*\.md)#[^)]*\)/](\1)/g
s/\[([^]]*)\]\(#[^)]*\)/\1/g
